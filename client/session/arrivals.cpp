#include "client/session/arrivals.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "client/hold/tile_cache.h"
#include "client/plan/selector.h"
#include "client/session/session_parts.h"
#include "protocol/codec/ground_codec.h"
#include "protocol/codec/model_codec.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/tile_key.h"
#include "protocol/wire/view_codec.h"

namespace mirage {
namespace {

constexpr std::size_t kMaxEarlyPages = 64;
constexpr std::size_t kReplyBytes = 64;  // control part and header of a reply with geometry

// True if the welcome announces the known scene with the same abilities of the server. The server
// may have been restarted with other options.
bool announces(const wire::WelcomeT& welcome, const SceneView& scene) {
  return welcome.revision == scene.revision && welcome.instances == scene.all_instances &&
         welcome.geometry == scene.geometry && welcome.reference == scene.reference &&
         welcome.shadows == scene.shadows &&
         (welcome.lighting->probe ? welcome.lighting->probe->id() : 0) == scene.lighting.probe.id;
}

// Returns the codecs on offer, the server's own choice first.
std::vector<TileCodec> offered_codecs(const wire::WelcomeT& welcome) {
  std::vector<TileCodec> out = {static_cast<TileCodec>(welcome.codec)};
  for (const std::uint8_t codec : welcome.codecs) {
    if (codec != welcome.codec) out.push_back(static_cast<TileCodec>(codec));
  }
  return out;
}

Result<void> accept_page(SceneView& scene, const Message& page) {
  const wire::BodyUnion& body = page.body;
  if (const wire::LightProbePageT* probe = body.AsLightProbePage()) {
    return scene.accept(*probe, page.payload);
  }
  if (const wire::ImagePageT* images = body.AsImagePage()) return scene.accept(*images);
  if (const wire::ObjectPageT* objects = body.AsObjectPage()) return scene.accept(*objects);
  return scene.accept(*body.AsInstancePage());
}

}  // namespace

Result<void> Arrivals::take(std::int64_t now_us) {
  Result<void> first_error;
  const auto cost = [this](const Message& message) { return upload_cost(message); };
  const auto first = [this](const Message& message) { return first_image(message); };
  for (Message& message : s_.held.uploads.take(s_.link.receive(), now_us, cost, first)) {
    Result<void> handled = handle(std::move(message), now_us);
    if (!handled && first_error.ok()) first_error = handled;
  }
  return first_error;
}

Result<void> Arrivals::handle(Message message, std::int64_t now_us) {
  if (!message.unpacked) {
    if (Result<void> done = unpacker_.unpack(message); !done) return done;
  }
  wire::BodyUnion& body = message.body;
  const std::int64_t came_us = now_us - message.waited_us;
  const bool was_complete = s_.scene.complete();
  switch (body.type) {
    case wire::Body::Catalogue:
      s_.light.own = false;  // everything in the folder has the scene's light
      return s_.asking.catalogue.accept(*body.AsCatalogue());
    case wire::Body::Welcome:
      return take_welcome(*body.AsWelcome(), came_us);
    case wire::Body::LightProbePage:
    case wire::Body::ImagePage:
    case wire::Body::ObjectPage:
      if (was_complete) return {};
      [[fallthrough]];
    case wire::Body::InstancePage:
      s_.asking.scheduler.note_opening(message.wire_bytes, came_us);
      if (Result<void> taken = take_page(std::move(message)); !taken) return taken;
      break;
    case wire::Body::TileReply:
      return take_tile(message, came_us, now_us);
    case wire::Body::MeshReply:
      return take_mesh(message, came_us, now_us);
    case wire::Body::ImageReply:
      return take_image(message, came_us, now_us);
    case wire::Body::ViewReply:
      return take_view(message, came_us);
    case wire::Body::GroundReply:
      return take_ground(message, came_us);
    case wire::Body::ReferenceReply:
      return take_reference(*body.AsReferenceReply(), message.payload);
    case wire::Body::Refused:
      take_refusal(*body.AsRefused(), now_us);
      return {};
    case wire::Body::Bye:
      s_.connection.goodbye = body.AsBye()->text;
      return {};
    default:
      return {};
  }
  take_scene(was_complete);
  return {};
}

Result<void> Arrivals::take_welcome(const wire::WelcomeT& welcome, std::int64_t came_us) {
  s_.asking.codec_choice.reset(offered_codecs(welcome));
  s_.asking.scheduler.note_welcome(came_us, came_us - s_.connection.greeted_us, welcome.tile_us);
  ++s_.connection.welcomes;
  s_.scene.note_choices(welcome);
  // A reconnect to the same scene keeps everything held valid, including its keys.
  if (s_.scene.complete() && announces(welcome, s_.scene)) {
    if (s_.light.own) s_.send_lighting();
    return {};
  }
  early_pages_.clear();
  if (welcome.revision != s_.scene.revision) {
    s_.held.views.forget();
    if (s_.scene.complete()) await_new_scene(came_us);
  }
  if (Result<void> taken = s_.scene.accept(welcome); !taken) return taken;
  take_scene(false);  // a scene without instances is complete at once
  return {};
}

// Asks for a view of the new scene from where the eye is. Things that the camera path leads past
// may not exist any more.
void Arrivals::await_new_scene(std::int64_t now_us) {
  s_.new_scene = {true, now_us};
  if (!s_.held.views.enabled() || s_.light.own) return;
  wire::ViewRequestT view = view_request(s_.camera, s_.time_s);
  view.request_id = s_.asking.scheduler.next_number();
  s_.held.views.asked(view.request_id);
  s_.link.send(encode_message(std::move(view)));
}

void Arrivals::take_scene(bool was_complete) {
  if (!s_.scene.complete()) return;
  if (was_complete) {
    s_.held.tiles.grow(s_.scene);
    s_.planning.eyes.grow(s_.scene);
    s_.held.meshes.grow(s_.scene);
    return;
  }
  if (!s_.light.own) s_.light.now = s_.scene.lighting;
  s_.held.tiles.reset(s_.scene, s_.light.now);
  s_.planning.eyes.reset(s_.scene);
  s_.held.shadows.reset();
  s_.asking.opener.reset();
  s_.asking.answered.reset();
  s_.asking.ground.reset();
  s_.held.ground.reset({s_.scene.home.walk_eye_m});
  s_.held.meshes.reset(s_.scene, s_.options.mesh_budget_bytes, s_.options.max_mesh_bytes);
  s_.moves = std::any_of(s_.scene.objects.begin(), s_.scene.objects.end(),
                         [](const ObjectDescription& o) { return o.moves(); });
  if (s_.sink.scene) s_.sink.scene(s_.scene);
  if (s_.light.own) s_.send_lighting();
}

Result<void> Arrivals::take_page(Message page) {
  Result<void> taken = accept_page(s_.scene, page);
  if (!taken) {
    if (taken.error().id != ErrorId::kWireState || early_pages_.size() >= kMaxEarlyPages) {
      return taken;
    }
    early_pages_.push_back(std::move(page));
    return {};
  }
  // Pages that came too early may follow on now, and others on them.
  auto early = early_pages_.begin();
  while (early != early_pages_.end()) {
    taken = accept_page(s_.scene, *early);
    if (taken) {
      early_pages_.erase(early);
      early = early_pages_.begin();
    } else if (taken.error().id == ErrorId::kWireState) {
      ++early;
    } else {
      return taken;
    }
  }
  return {};
}

Result<void> Arrivals::take_tile(const Message& message, std::int64_t came_us,
                                 std::int64_t now_us) {
  const wire::TileReplyT& reply = *message.body.AsTileReply();
  ++s_.tally.received;
  const std::size_t bytes = tile_credit_bytes(message.payload_bytes);
  const std::optional<PendingAsk> ask = s_.asking.scheduler.finish(
      reply.request_id, bytes, {reply.server_us, std::int64_t{reply.render_us} + reply.encode_us},
      came_us);
  if (!ask || !s_.scene.complete()) return {};
  s_.asking.codec_choice.tile_arrived(came_us - ask->sent_us, reply.server_us);
  if (is_picture(ask->need.channels)) {
    s_.planning.eyes.note_tile(ask->object, static_cast<double>(bytes));
  }
  if (reply.edge != tile_edge(ask->need.size_class)) {
    return make_error(ErrorId::kWireValue, "tile has another size than asked for");
  }
  if (reply.channels != ask->need.channels) {
    return make_error(ErrorId::kWireValue, "tile has other channels than asked for");
  }
  s_.asking.answered.note(ask->need, now_us);
  const ObjectDescription& object = s_.scene.objects[ask->object];
  const Capture capture(ask->need.cell, ask->need.distance, object.radius, reply.edge);
  // Another instance of the object has received this tile meanwhile.
  if (is_picture(reply.channels) &&
      s_.held.tiles.holds(ask->need.instance, capture, reply.channels == kRelitTile,
                          ask->need.phase, ask->need.light)) {
    return {};
  }
  Result<UnpackedTile> taken = read_unpacked_tile(message);
  if (!taken) return taken.error();
  s_.tally.note_decoded(reply, message.payload_bytes);
  if (!is_picture(reply.channels)) {
    take_shadow(*ask, capture, *taken);
    return {};
  }
  const TileRecordPtr record =
      s_.held.tiles.insert(ask->need.instance, s_.scene, capture, std::move(taken->tile), s_.frame,
                           now_us, ask->need.light, ask->need.phase);
  if (!record) return {};
  std::size_t life = SIZE_MAX;
  if (s_.options.trace) {
    life = s_.tally.trace.begin({reply.request_id, s_.scene.object_id(ask->need.instance),
                                 s_.scene.instances[ask->need.instance].id,
                                 tile_edge(ask->need.size_class), ask->sent_us, came_us, now_us, -1,
                                 reply.queue_us, reply.render_us, reply.encode_us, bytes});
  }
  s_.tally.note_held(record, life);
  s_.held.uploads.uploaded(tile_upload_bytes(record->crop.w, record->crop.h, reply.channels), true);
  if (s_.sink.tile) s_.sink.tile(*record, taken->planes);
  if (s_.options.trace_clock) s_.tally.trace.uploaded(life, s_.options.trace_clock());
  return {};
}

void Arrivals::take_shadow(const PendingAsk& ask, const Capture& capture,
                           const UnpackedTile& taken) {
  const Tile& tile = taken.tile;
  const ShadowRecordPtr record =
      s_.held.shadows.insert(ask.need, ask.object, capture, tile.crop, s_.frame);
  if (!record) return;
  ++s_.tally.drawn;
  const bool caster = tile.channels == kCasterTile;
  s_.held.uploads.uploaded(tile_upload_bytes(tile.crop.w, tile.crop.h, tile.channels), true);
  if (s_.sink.shadow) s_.sink.shadow(*record, caster ? taken.planes.depth : taken.planes.shadow);
}

void Arrivals::take_refusal(const wire::RefusedT& refused, std::int64_t now_us) {
  if (refused.request_id == 0) {
    s_.reference.refused = true;
    return;
  }
  if (s_.held.views.refused(refused, now_us)) return;
  if (s_.asking.ground.refused(refused.request_id, now_us)) return;
  ++s_.tally.refused;
  const PendingAsk* ask = s_.asking.scheduler.pending(refused.request_id);
  if (ask && refused.reason != wire::RefusalReason::Busy &&
      refused.reason != wire::RefusalReason::Late) {
    s_.asking.answered.note(ask->need, now_us);
  }
  s_.asking.scheduler.refuse(refused.request_id, now_us);
}

std::size_t Arrivals::upload_cost(const Message& message) const {
  const wire::BodyUnion& body = message.body;
  if (const wire::TileReplyT* tile = body.AsTileReply()) {
    return tile_upload_bytes(tile->crop_w, tile->crop_h, tile->channels);
  }
  if (const wire::MeshReplyT* mesh = body.AsMeshReply()) {
    const bool known = mesh->object < s_.scene.objects.size() &&
                       mesh->lod < s_.scene.objects[mesh->object].lods.size();
    return known ? expected_gpu_bytes(s_.scene.objects[mesh->object].lods[mesh->lod]) : 0;
  }
  const wire::ImageReplyT* image = body.AsImageReply();
  if (!image || image->image >= s_.scene.images.size()) return 0;
  return image_gpu_bytes(image_level_size(s_.scene.images[image->image], image->level));
}

bool Arrivals::first_image(const Message& message) const {
  const wire::TileReplyT* tile = message.body.AsTileReply();
  const PendingAsk* ask = tile ? s_.asking.scheduler.pending(tile->request_id) : nullptr;
  return ask && is_picture(ask->need.channels) &&
         !s_.held.tiles.group_to_draw(ask->need.instance)->known();
}

// Succeeds if the reply is what was asked for under this id, and the scene is still the same.
Result<void> Arrivals::finish_asset(std::uint32_t request_id, const AssetId& id, std::size_t bytes,
                                    std::int64_t came_us) {
  const std::optional<AssetNeed> need =
      s_.asking.scheduler.finish_asset(request_id, bytes + kReplyBytes, came_us);
  if (need && s_.scene.complete() && need->id == id) return {};
  return make_error(ErrorId::kWireValue, "geometry or an image that was not asked for");
}

Result<void> Arrivals::take_mesh(const Message& message, std::int64_t came_us,
                                 std::int64_t now_us) {
  const wire::MeshReplyT& reply = *message.body.AsMeshReply();
  const Bytes& bytes = message.payload;
  const AssetId id{AssetId::Kind::kMesh, reply.object, reply.lod};
  const Result<void> asked = finish_asset(reply.request_id, id, message.payload_bytes, came_us);
  if (!asked) return asked.error();
  if (reply.raw_bytes > s_.options.max_mesh_bytes) {
    return make_error(ErrorId::kWireLimit, "geometry is larger than asked for");
  }
  Result<ObjectModel> model = decode_model(bytes.data(), bytes.size(), s_.scene.images.size());
  if (!model) return model.error();
  s_.held.shadows.assets_changed();
  s_.held.meshes.add_mesh(reply.object, reply.lod, *model, now_us);
  s_.held.uploads.uploaded(mesh_gpu_bytes(model->mesh), false);
  if (s_.sink.mesh) s_.sink.mesh(reply.object, reply.lod, model.take());
  return {};
}

Result<void> Arrivals::take_image(const Message& message, std::int64_t came_us,
                                  std::int64_t now_us) {
  const wire::ImageReplyT& reply = *message.body.AsImageReply();
  const AssetId id{AssetId::Kind::kImage, reply.image, reply.level};
  const Result<void> asked = finish_asset(reply.request_id, id, message.payload_bytes, came_us);
  if (!asked) return asked.error();
  const ImageDescription& description = s_.scene.images[reply.image];
  const glm::uvec2 size = image_level_size(description, reply.level);
  Result<std::vector<Image>> levels =
      read_unpacked_image(message.payload, size, description.srgb, description.alpha_cutoff > 0);
  if (!levels) return levels.error();
  const Image image = std::move(levels->front());
  levels->erase(levels->begin());
  s_.held.shadows.assets_changed();
  s_.held.meshes.add_image(s_.scene, reply.image, reply.level, message.payload_bytes, now_us);
  s_.held.uploads.uploaded(image_gpu_bytes(size), false);
  if (s_.sink.image) s_.sink.image(reply.image, image, *levels);
  return {};
}

Result<void> Arrivals::take_ground(const Message& message, std::int64_t came_us) {
  const wire::GroundReplyT& reply = *message.body.AsGroundReply();
  s_.asking.scheduler.note_other(message.payload_bytes + kReplyBytes, came_us);
  const GroundBlockId id{reply.x, reply.z};
  if (!s_.asking.ground.finish(reply.request_id, id)) {
    return make_error(ErrorId::kWireValue, "ground that was not asked for");
  }
  Result<GroundBlock> block = decode_ground(message.payload, reply.raw_bytes);
  if (!block) return block.error();
  block->id = id;
  s_.held.ground.add(block.take());
  return {};
}

Result<void> Arrivals::take_view(const Message& message, std::int64_t came_us) {
  const std::size_t size = message.payload_bytes + kReplyBytes;
  if (s_.scene.complete()) {
    s_.asking.scheduler.note_other(size, came_us);
  } else {
    s_.asking.scheduler.note_opening(size, came_us);
  }
  const Result<std::shared_ptr<const ViewTile>> view = s_.held.views.take(message);
  if (!view) return view.error();
  if (*view && s_.sink.view) s_.sink.view(**view);
  return {};
}

Result<void> Arrivals::take_reference(const wire::ReferenceReplyT& reply, const Bytes& bytes) {
  const std::size_t pixels = std::size_t{reply.width} * reply.height;
  const bool asked = std::exchange(s_.reference.asked_px, 0) == pixels && pixels > 0;
  if (!asked || reply.raw_bytes != pixels * 12) {
    return make_error(ErrorId::kWireValue, "reference frame that was not asked for");
  }
  if (bytes.size() != reply.raw_bytes) {
    return make_error(ErrorId::kWireValue, "a reference frame of another size than it says");
  }
  ReferenceFrame frame{reply.width,
                       reply.height,
                       {},
                       std::vector<float>(pixels),
                       std::vector<std::uint32_t>(pixels)};
  frame.rgba.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(pixels * 4));
  std::memcpy(frame.depth.data(), bytes.data() + pixels * 4, pixels * 4);
  std::memcpy(frame.ids.data(), bytes.data() + pixels * 8, pixels * 4);
  s_.reference.frame = std::move(frame);
  return {};
}

}  // namespace mirage
