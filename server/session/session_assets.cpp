// Sessions: everything except tiles and views. Geometry, images, ground, full renders and
// statistics.
#include "protocol/impostor/tile_key.h"
#include "protocol/wire/conversions.h"
#include "server/prepare/object_geometry.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/encoded_cache.h"
#include "server/session/session.h"
#include "server/tile/tile_job.h"

namespace mirage {
namespace {
// Blocks of ground that a client may wait for. Mirage's own client asks for four at a time.
constexpr std::size_t kMostGroundAsks = 8;
}  // namespace

void SessionHub::mesh_ask(SessionId id, Session& s, const wire::MeshAsk& ask) {
  // No client knows an object before, except from a server that ended.
  if (pages_.empty()) return refuse(id, ask.request_id(), wire::RefusalReason::Busy);
  const bool known = ask.object() < scene_->geometry.size() &&
                     ask.lod() < scene_->geometry[ask.object()].encoded.size();
  if (!known) return refuse(id, ask.request_id(), wire::RefusalReason::UnknownObject);
  if (!options_.geometry || !s.grant.geometry)
    return refuse(id, ask.request_id(), wire::RefusalReason::NoGeometry);
  const EncodedLod& lod = scene_->geometry[ask.object()].encoded[ask.lod()];
  if (lod.payload.size() > limits::kMaxTransferBytes / 2) {
    return refuse(id, ask.request_id(), wire::RefusalReason::TooLarge);
  }
  if (s.meshes.size() >= limits::kMaxQueuedAsksPerClient) {
    return refuse(id, ask.request_id(), wire::RefusalReason::Busy);
  }
  s.meshes.push_back(ask);
  writable_.insert(id);
}

void SessionHub::push_mesh(SessionId id, Session& s) {
  const wire::MeshAsk ask = s.meshes.front();
  s.meshes.pop_front();
  const EncodedLod& lod = scene_->geometry[ask.object()].encoded[ask.lod()];
  wire::MeshReplyT reply;
  reply.request_id = ask.request_id();
  reply.object = ask.object();
  reply.lod = ask.lod();
  reply.raw_bytes = lod.raw_bytes;
  ++counters_.meshes_sent;
  push(id, Outbox::Lane::kLarge, encode_message(std::move(reply), lod.payload));
}

void SessionHub::image_ask(SessionId id, Session& s, const wire::ImageAsk& ask) {
  const bool known = ask.image() < scene_->images.size() &&
                     ask.level() < image_levels(scene_->images[ask.image()]);
  if (!known) return refuse(id, ask.request_id(), wire::RefusalReason::UnknownObject);
  if (!options_.geometry || !s.grant.geometry)
    return refuse(id, ask.request_id(), wire::RefusalReason::NoGeometry);
  if (s.outbox.full()) return refuse(id, ask.request_id(), wire::RefusalReason::Busy);
  const ImageLevel level{ask.image(), ask.level()};
  if (const Bytes* encoded = parts_->images.find(level)) {
    return push_image(id, ask.request_id(), level, *encoded);
  }
  if (!parts_->images.wait(level, {id, ask.request_id()})) {
    refuse(id, ask.request_id(), wire::RefusalReason::Busy);
  }
}

void SessionHub::push_image(SessionId id, std::uint32_t request, const ImageLevel& level,
                            const Bytes& bytes) {
  const auto at = sessions_.find(id);
  if (at == sessions_.end()) return;
  if (at->second.outbox.full()) return refuse(id, request, wire::RefusalReason::Busy);
  if (bytes.empty()) return refuse(id, request, wire::RefusalReason::TooLarge);
  wire::ImageReplyT reply;
  reply.request_id = request;
  reply.image = level.image;
  reply.level = level.level;
  ++counters_.images_sent;
  push(id, Outbox::Lane::kBulk, encode_message(std::move(reply), bytes));
}

void SessionHub::finish(FinishedImage done) {
  for (const auto& [session, request] : parts_->images.take_waiting(done.level)) {
    push_image(session, request, done.level, done.bytes);
  }
  const std::size_t bytes = done.bytes.size();
  parts_->images.keep(done.level, std::move(done.bytes), bytes);
}

void SessionHub::ground(SessionId id, Session& s, const wire::GroundRequestT& m) {
  if (!(scene_->scene.home.walk_eye_m > 0)) {
    return refuse(id, m.request_id, wire::RefusalReason::UnknownObject);
  }
  const GroundBlockId block{m.x, m.z};
  if (const EncodedGround* made = parts_->grounds.find(block)) {
    return push_ground(id, m.request_id, block, *made);
  }
  const bool busy = s.outbox.full() || parts_->grounds.asks_of(id) >= kMostGroundAsks;
  if (busy || !parts_->grounds.wait(block, {id, m.request_id})) {
    refuse(id, m.request_id, wire::RefusalReason::Busy);
  }
}

void SessionHub::push_ground(SessionId id, std::uint32_t request, GroundBlockId block,
                             const EncodedGround& ground) {
  const auto at = sessions_.find(id);
  if (at == sessions_.end()) return;
  if (at->second.outbox.full()) return refuse(id, request, wire::RefusalReason::Busy);
  if (ground.raw_bytes == 0) return refuse(id, request, wire::RefusalReason::TooLarge);
  wire::GroundReplyT reply;
  reply.request_id = request;
  reply.x = block.x;
  reply.z = block.z;
  reply.raw_bytes = ground.raw_bytes;
  push(id, Outbox::Lane::kControl, encode_message(std::move(reply), ground.bytes));
}

void SessionHub::finish(FinishedGround done) {
  for (const auto& [session, request] : parts_->grounds.take_waiting(done.block)) {
    push_ground(session, request, done.block, done.ground);
  }
  if (done.ground.raw_bytes == 0) return;  // it may succeed later
  const std::size_t bytes = done.ground.bytes.size() + sizeof(EncodedGround);
  parts_->grounds.keep(done.block, std::move(done.ground), bytes);
}

void SessionHub::reference(SessionId id, Session& s, const wire::ReferenceRequestT& m) {
  if (!options_.reference || !s.grant.reference) {
    return refuse(id, m.request_id, wire::RefusalReason::NoReference);
  }
  const auto found = s.lighting.find(m.lighting_id);
  const bool known = m.lighting_id == 0 || found != s.lighting.end();
  if (!known || !limits::reference_within_limits(m.width, m.height, m.supersample)) {
    return refuse(id, m.request_id, wire::RefusalReason::TooLarge);
  }
  SceneShot shot;
  shot.camera.pose = {from_wire(*m.eye), glm::normalize(from_wire(*m.rotation))};
  shot.camera.fov_y = m.fov_y;
  shot.camera.width = m.width;
  shot.camera.height = m.height;
  shot.camera.shift_px = {m.shift_x, m.shift_y};
  shot.camera.pixel_aspect = m.pixel_aspect;
  shot.camera.fit_depth_range(scene_->bounds_center, scene_->bounds_radius);
  shot.supersample = m.supersample;
  shot.time_s = m.time_s;
  shot.lighting = found != s.lighting.end() ? found->second : scene_->scene.lighting;
  const std::size_t bytes = limits::reference_bytes(m.width, m.height);
  if (s.full_render != Session::FullRender::kNone || !full_render_fits(bytes) ||
      !queue_.submit(ReferenceJob{id, m.request_id, std::move(shot)})) {
    return refuse(id, m.request_id, wire::RefusalReason::Busy);
  }
  s.full_render = Session::FullRender::kUnderWay;
  s.full_render_bytes = bytes;
}

bool SessionHub::full_render_fits(std::size_t more) const {
  std::size_t all = more;
  for (const auto& [id, s] : sessions_) {
    if (s.full_render != Session::FullRender::kNone) all += s.full_render_bytes;
  }
  return all <= limits::kMaxFullRenderBytes;
}

void SessionHub::stats(SessionId id, const wire::StatsRequestT& m) {
  wire::StatsT out;
  out.request_id = m.request_id;
  out.tiles_rendered = counters_.tiles_rendered;
  out.tiles_merged = counters_.tiles_merged;
  out.store_hits = counters_.store_hits;
  out.store_bytes = counters_.store_bytes;
  out.tiles_cancelled = counters_.tiles_cancelled;
  out.tiles_late = counters_.tiles_late;
  out.queue_length = static_cast<std::uint32_t>(queue_.length());
  out.clients = static_cast<std::uint32_t>(sessions_.size());
  push(id, Outbox::Lane::kControl, encode_message(std::move(out)));
}

}  // namespace mirage
