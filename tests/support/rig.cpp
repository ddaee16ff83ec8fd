#include "tests/support/rig.h"

#include <time.h>

#include <cmath>

#include "client/frame/planned_frame.h"
#include "client/session/tile_sink.h"
#include "protocol/codec/atlas_planes.h"
#include "protocol/impostor/capture.h"
#include "server/stage/image_stage.h"
#include "server/tile/tile_form.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

constexpr int kRow = 6;  // objects in a row

std::uint32_t mixed(std::uint64_t v) {
  v = (v ^ (v >> 33)) * 0xff51afd7ed558ccdull;
  v = (v ^ (v >> 33)) * 0xc4ceb9fe1a85ec53ull;
  return static_cast<std::uint32_t>(v ^ (v >> 33));
}

// Blocks of 2 x 2 texels in one colour compress to about the 0.7 bytes a texel of real tiles.
void paint(Tile& tile, std::uint64_t seed) {
  const std::size_t w = tile.crop.w, h = tile.crop.h;
  tile.rgba.resize(w * h * 4);
  tile.depth.assign(w * h, 128);
  if (tile.relit()) tile.surface.assign(w * h * 4, 128);
  for (std::size_t y = 0; y < h; ++y) {
    for (std::size_t x = 0; x < w; ++x) {
      const std::uint32_t c = mixed(seed + (y / 2) * w + x / 2);
      std::uint8_t* texel = &tile.rgba[(y * w + x) * 4];
      for (int k = 0; k < 3; ++k) texel[k] = static_cast<std::uint8_t>(c >> (8 * k));
      texel[3] = 255;
    }
  }
}

}  // namespace

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::shared_ptr<const PreparedScene> rig_scene(const RigScene& options) {
  const auto knot = *load_scene("builtin:knot?tubular=16&radial=8");
  auto out = std::make_shared<PreparedScene>(*knot);
  const auto copies = static_cast<std::size_t>(options.objects);
  out->scene.objects.assign(copies, knot->scene.objects[0]);
  out->objects.assign(copies, knot->objects[0]);
  out->geometry.assign(copies, knot->geometry[0]);
  out->scene.instances.assign(copies, knot->scene.instances[0]);
  out->grouping = no_groups(copies);
  const double size = 1 / double{out->objects[0].radius};
  for (std::size_t i = 0; i < copies; ++i) {
    Instance& instance = out->scene.instances[i];
    instance.object = static_cast<std::uint32_t>(i);
    instance.world_from_object.scale = static_cast<float>(size);
    const auto row = static_cast<double>(i / kRow), column = static_cast<double>(i % kRow);
    instance.world_from_object.position = {(column - 2.5) * options.spacing_m, 1.0,
                                           -row * options.spacing_m};
    if (options.clip_s <= 0) continue;
    out->objects[i].motion.clip_s = static_cast<float>(options.clip_s);
    out->objects[i].motion.speed.assign(limits::kMotionSegments, 0.3f);
  }
  out->bounds_radius = options.spacing_m * std::max(4.0, static_cast<double>(copies) / kRow);
  out->revision ^= copies;
  return out;
}

Host::Host(std::shared_ptr<const PreparedScene> scene, const Clock& clock, SessionOptions options)
    : scene_(std::move(scene)), queues_(clock, 64u << 20, {}) {
  options.geometry = false;
  hub_ = std::make_unique<SessionHub>(scene_, std::move(options), queues_);
}

StoredTilePtr Host::make(const TileJob& job) const {
  const double radius = scene_->objects[job.key.object].radius;
  const Capture capture(job.key.cell, job.key.distance, radius, tile_edge(job.key.size_class));
  Tile tile = make_tile(capture);
  tile.channels = job.key.channels;
  paint(tile, job.id.low);
  return make_form(tile, {}, job.codec);
}

void Host::make_forms() {
  while (const std::optional<EncodeJob> job = queues_.rendered.try_pop()) {
    const FormJob& form = std::get<FormJob>(*job);
    const StoredTilePtr tile = convert_form(form.lossless, form.codec);
    queues_.store.put(form.id, form.codec, tile);
    hub_->complete(FinishedTile{form.id, form.codec, tile});
  }
}

std::size_t Host::render(std::size_t count) {
  make_forms();
  std::size_t left = count, done = 0;
  const auto work =
      queues_.tiles.take({[&](std::uint32_t) { return left > 0 && left-- > 0; }}, false);
  if (!work || !std::holds_alternative<std::vector<TileJob>>(*work)) return 0;
  for (const TileJob& job : std::get<std::vector<TileJob>>(*work)) {
    const StoredTilePtr tile = make(job);
    queues_.store.put(job.id, job.codec, tile);
    hub_->complete(FinishedTile{job.id, job.codec, tile, tile});
    make_forms();
    ++done;
  }
  return done;
}

std::vector<Message> Host::messages_for(SessionId id) {
  std::vector<Message> out;
  PacketAssembler assembler(limits::kMaxTransferBytes);
  while (const PacketPtr packet = hub_->next_packet(id)) {
    Result<std::optional<Bytes>> whole = assembler.accept(packet->data(), packet->size());
    if (!whole || !whole->has_value()) continue;
    Result<Message> message = decode_message((*whole)->data(), (*whole)->size());
    if (message) out.push_back(message.take());
  }
  return out;
}

void HostLink::connect() {
  disconnect();
  id_ = host_.hub().open();
  up_ = true;
  ++generation_;
}

void HostLink::disconnect() {
  if (up_) host_.hub().close(id_);
  up_ = false;
}

void HostLink::send(Bytes bytes) {
  if (!up_) return;
  const double began = thread_seconds();
  const Result<void> taken = host_.hub().receive(id_, bytes.data(), bytes.size());
  if (!taken && complaint_.empty()) complaint_ = taken.error().line();
  ++batches_;
  host_.add_busy(thread_seconds() - began);
}

std::vector<Message> HostLink::receive() {
  if (!up_) return {};
  const double began = thread_seconds();
  while (renders_ && host_.render() > 0) {
  }
  std::vector<Message> out = host_.messages_for(id_);
  host_.add_busy(thread_seconds() - began);
  return out;
}

Rig::Rig(std::shared_ptr<const PreparedScene> scene, const RigOptions& options)
    : host(std::move(scene), server_clock, {}),
      server_link(host),
      link(server_link, clock, options.net, true, [] { return false; }),
      wrapped(options.wrap ? options.wrap(link) : nullptr),
      session(wrapped ? *wrapped : link, options.client, sink()),
      frame_us_(options.frame_us) {
  camera.width = 320;
  camera.height = 180;
}

TileSink Rig::sink() {
  TileSink sink;
  sink.tile = [this](const TileRecord& record, const AtlasPlanes& planes) {
    uploaded_bytes += planes.color.size() + planes.depth.size() + planes.surface.size();
    if (on_tile) on_tile(record, planes);
  };
  return sink;
}

DrawList Rig::frame(const Pose& pose) {
  const auto mine = [&] { return thread_seconds() - host.busy_s(); };
  const double began = mine();
  const std::int64_t now = clock.now_us() + client_offset_us;
  if (Result<void> received = session.receive(now); !received) {
    errors.push_back(received.error().line());
  }
  camera.pose = pose;
  camera.fit_depth_range(session.scene().bounds_center, session.scene().bounds_radius);
  const double received_at = mine();
  DrawList list = session.frame(camera, now).list;
  const double ended = mine();
  frame_ms.push_back(1000 * (ended - began));
  deciding_ms.push_back(1000 * (ended - received_at));
  clock.set_us(clock.now_us() + frame_us_);
  server_clock.set_us(server_clock.now_us() + frame_us_);
  return list;
}

DrawList Rig::run(double seconds, const std::function<Pose(double)>& pose) {
  DrawList list;
  const std::int64_t end = clock.now_us() + std::llround(seconds * 1e6);
  while (clock.now_us() < end) list = frame(pose(now_s()));
  return list;
}

Pose eye_at(const glm::dvec3& at, const glm::dvec3& target) {
  return look_at(at + glm::dvec3(0, 1.7, 0), target + glm::dvec3(0, 1, 0));
}

}  // namespace mirage::test
