#include "client/session/client_session.h"

#include <algorithm>
#include <utility>

#include "protocol/limits.h"

namespace mirage {
namespace {
// What a tile is asked for lies this far beyond the round trip: half of its expected life.
constexpr std::int64_t kHorizonSlackUs = 150'000;
constexpr std::int64_t kMaxHorizonUs = 1'000'000;
constexpr double kStandsM = 1e-6;  // from where the eye is expected to be
// At rest geometry is drawn as if tau were so much less: nothing else is left to be asked for.
constexpr double kRestTauShare = 0.25;
constexpr float kFacesSame = 0.999999f;  // half the angle's cosine: 0.16 degrees
constexpr std::size_t kMaxEarlyPages = 64;

// Also what the server can do: it may have been started anew with other options.
bool announces(const wire::WelcomeT& welcome, const SceneView& scene) {
  return welcome.revision == scene.revision && welcome.instances == scene.all_instances &&
         welcome.geometry == scene.geometry && welcome.reference == scene.reference &&
         welcome.shadows == scene.shadows &&
         (welcome.lighting->probe ? welcome.lighting->probe->id() : 0) == scene.lighting.probe.id;
}

// The server's own choice first.
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

ClientSession::ClientSession(Link& link, ClientOptions options, TileSink sink)
    : link_(link),
      options_(std::move(options)),
      sink_(std::move(sink)),
      cache_(options_.atlas_edge, options_.atlas_layers),
      relight_(options_.relight),
      uploads_(options_.upload_budget_bytes),
      views_(options_.views && options_.method.automatic && options_.shadows),
      tau_(options_.tau_px, options_.targets),
      plan_(options_.frame_ms, options_.samples),
      codec_choice_(options_.codec) {}

void ClientSession::greet(std::int64_t now_us) {
  greeted_us_ = now_us;
  generation_ = link_.generation();
  goodbye_.clear();
  scheduler_.reset();
  opener_.reset();
  uploads_.clear();
  wire::HelloT hello;
  hello.version_min = hello.version_max = limits::kProtocolVersion;
  hello.token = options_.token;
  hello.name = options_.name;
  hello.codecs = every_codec();
  views_.reset();
  // Under a light of its own this client has to say first which it is.
  if (views_.enabled() && !own_lighting_ && !scene_.complete()) {
    hello.view = std::make_unique<wire::ViewRequestT>(view_request(options_.screen, 0));
    hello.view->home = true;
    hello.view->request_id = scheduler_.next_number();
    views_.asked(hello.view->request_id);
  }
  link_.send(encode_message(std::move(hello)));
}

std::int64_t ClientSession::steady_us(std::int64_t now_us) {
  if (now_us < told_us_) set_back_us_ += told_us_ - now_us;
  told_us_ = now_us;
  return now_us + set_back_us_;
}

Result<void> ClientSession::receive(std::int64_t told_us) {
  const std::int64_t now_us = steady_us(told_us);
  if (link_.connected() && link_.generation() != generation_) greet(now_us);
  Result<void> first_error;
  const auto cost = [this](const Message& message) { return upload_cost(message); };
  const auto first = [this](const Message& message) { return first_image(message); };
  for (Message& message : uploads_.take(link_.receive(), now_us, cost, first)) {
    Result<void> handled = handle(std::move(message), now_us);
    if (!handled && first_error.ok()) first_error = handled;
  }
  return first_error;
}

Result<void> ClientSession::handle(Message message, std::int64_t now_us) {
  wire::BodyUnion& body = message.body;
  const std::int64_t came_us = now_us - message.waited_us;
  const bool was_complete = scene_.complete();
  switch (body.type) {
    case wire::Body::Welcome: {
      const wire::WelcomeT& welcome = *body.AsWelcome();
      codec_choice_.reset(offered_codecs(welcome));
      scheduler_.note_welcome(came_us, came_us - greeted_us_, welcome.tile_us);
      // The same scene after a reconnect: everything held stays valid, keys and all.
      if (was_complete && announces(welcome, scene_)) {
        if (own_lighting_) send_lighting();
        return {};
      }
      early_pages_.clear();
      if (welcome.revision != scene_.revision) views_.forget();
      if (Result<void> taken = scene_.accept(welcome); !taken) return taken;
      take_scene(false);  // a scene without instances is complete at once
      return {};
    }
    case wire::Body::LightProbePage:
    case wire::Body::ImagePage:
    case wire::Body::ObjectPage:
      if (was_complete) return {};
      [[fallthrough]];
    case wire::Body::InstancePage:
      scheduler_.note_opening(message.wire_bytes, came_us);
      if (Result<void> taken = take_page(std::move(message)); !taken) return taken;
      break;
    case wire::Body::TileReply:
      return take_tile(*body.AsTileReply(), message.payload, came_us, now_us);
    case wire::Body::MeshReply:
      return take_mesh(*body.AsMeshReply(), message.payload, came_us, now_us);
    case wire::Body::ImageReply:
      return take_image(*body.AsImageReply(), message.payload, came_us, now_us);
    case wire::Body::ViewReply:
      return take_view(*body.AsViewReply(), message.payload, came_us);
    case wire::Body::ReferenceReply:
      return take_reference(*body.AsReferenceReply(), message.payload);
    case wire::Body::Refused:
      take_refusal(*body.AsRefused(), now_us);
      return {};
    case wire::Body::Bye:
      goodbye_ = body.AsBye()->text;
      return {};
    default:
      return {};
  }
  take_scene(was_complete);
  return {};
}

void ClientSession::take_scene(bool was_complete) {
  if (!scene_.complete()) return;
  if (was_complete) {
    cache_.grow(scene_);
    selector_.grow(scene_);
    meshes_.grow(scene_);
    return;
  }
  if (!own_lighting_) lighting_ = scene_.lighting;
  cache_.reset(scene_, lighting_);
  selector_.reset(scene_);
  shadows_.reset();
  opener_.reset();
  meshes_.reset(scene_, options_.mesh_budget_bytes, options_.max_mesh_bytes);
  predictor_ = Predictor(std::max(50.0, 0.5 * scene_.bounds_radius));
  moves_ = std::any_of(scene_.objects.begin(), scene_.objects.end(),
                       [](const ObjectDescription& o) { return o.motion.moving(); });
  if (sink_.scene) sink_.scene(scene_);
  if (own_lighting_) send_lighting();
}

Result<void> ClientSession::take_page(Message page) {
  Result<void> taken = accept_page(scene_, page);
  if (!taken) {
    if (taken.error().id != ErrorId::kWireState || early_pages_.size() >= kMaxEarlyPages) {
      return taken;
    }
    early_pages_.push_back(std::move(page));
    return {};
  }
  // What came too early may follow on now, and others on it.
  auto early = early_pages_.begin();
  while (early != early_pages_.end()) {
    taken = accept_page(scene_, *early);
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

Result<void> ClientSession::take_tile(const wire::TileReplyT& reply, const Bytes& planes,
                                      std::int64_t came_us, std::int64_t now_us) {
  ++received_;
  const std::size_t bytes = tile_credit_bytes(planes.size());
  const std::optional<PendingAsk> ask =
      scheduler_.finish(reply.request_id, bytes, reply.server_us, came_us);
  if (!ask || !scene_.complete()) return {};
  codec_choice_.tile_arrived(came_us - ask->sent_us, reply.server_us);
  if (is_picture(ask->need.channels)) {
    selector_.note_tile(ask->object, static_cast<double>(bytes));
  }
  Result<Tile> tile = tile_from_fields(reply);
  if (!tile) return tile.error();
  if (tile->edge != tile_edge(ask->need.size_class)) {
    return make_error(ErrorId::kWireValue, "tile has another size than asked for");
  }
  if (tile->channels != ask->need.channels) {
    return make_error(ErrorId::kWireValue, "tile has other channels than asked for");
  }
  const ObjectDescription& object = scene_.objects[ask->object];
  const Capture capture(ask->need.cell, ask->need.distance, object.radius, tile->edge);
  // Another instance of the object got it meanwhile.
  if (is_picture(tile->channels) &&
      cache_.holds(ask->need.instance, capture, tile->relit(), ask->need.phase, ask->need.light)) {
    return {};
  }
  if (Result<void> decoded = decode(reply, planes, *tile); !decoded) return decoded;
  if (!is_picture(tile->channels)) {
    take_shadow(*ask, capture, tile.take());
    return {};
  }
  const TilePixels pixels{std::move(tile->rgba), std::move(tile->surface), std::move(tile->behind)};
  const TileRecordPtr record = cache_.insert(ask->need.instance, scene_, capture, tile.take(),
                                             frame_, now_us, ask->need.light, ask->need.phase);
  if (!record) return {};
  std::size_t life = SIZE_MAX;
  if (options_.trace) {
    life = trace_.begin({reply.request_id, scene_.object_id(ask->need.instance),
                         scene_.instances[ask->need.instance].id, tile_edge(ask->need.size_class),
                         ask->sent_us, came_us, now_us, -1, reply.queue_us, reply.render_us,
                         reply.encode_us, bytes});
  }
  undrawn_.push_back({record, life});
  uploads_.uploaded(tile_upload_bytes(record->crop.w, record->crop.h, reply.channels), true);
  if (sink_.tile) sink_.tile(*record, pixels);
  if (options_.trace_clock) trace_.uploaded(life, options_.trace_clock());
  return {};
}

Result<void> ClientSession::decode(const wire::TileReplyT& reply, const Bytes& planes, Tile& tile) {
  const auto codec = static_cast<TileCodec>(reply.codec);
  Result<void> decoded = decode_tile_planes(planes.data(), planes.size(), codec, tile);
  if (!decoded) return decoded;
  CodecUse& use = codec_uses_[reply.codec];
  ++use.tiles;
  use.bytes += planes.size();
  if (is_lossy(codec)) use.color_rms.push_back(reply.color_rms);
  use.color_max = std::max(use.color_max, reply.color_max);
  return {};
}

void ClientSession::take_shadow(const PendingAsk& ask, const Capture& capture, const Tile& tile) {
  const ShadowRecordPtr record = shadows_.insert(ask.need, ask.object, capture, tile.crop, frame_);
  if (!record) return;
  ++drawn_;
  const bool caster = tile.channels == kCasterTile;
  uploads_.uploaded(tile_upload_bytes(tile.crop.w, tile.crop.h, tile.channels), true);
  const auto& sink = caster ? sink_.caster : sink_.shadow;
  if (sink) sink(*record, caster ? tile.depth : tile.shadow);
}

void ClientSession::take_refusal(const wire::RefusedT& refused, std::int64_t now_us) {
  if (refused.request_id == 0) {
    reference_refused_ = true;
    return;
  }
  if (views_.refused(refused, now_us)) return;
  ++refused_;
  scheduler_.refuse(refused.request_id, now_us);
}

void ClientSession::set_lighting(const Lighting& lighting, std::int64_t told_us) {
  const std::int64_t now_us = steady_us(told_us);
  own_lighting_ = true;
  lighting_ = lighting;
  if (!scene_.complete()) return;
  send_lighting();
  const LightHistory& lights = cache_.lights();
  const std::uint32_t before = lights.current().serial;
  const std::uint32_t latest = lights.latest_serial();
  cache_.relight(lighting_, now_us);
  shadows_.relight(now_us);
  light_changed_ = light_changed_ || lights.current().serial != before;
  if (lights.latest_serial() != latest) relight_.new_light(now_us);
}

void ClientSession::send_lighting() {
  wire::SetLightingT message;
  message.id = ++lighting_id_;
  message.lighting = to_wire(lighting_);
  link_.send(encode_message(std::move(message)));
}

// Predict: where the eye is and will be when what is asked for now is here, and by which tau.
ClientSession::Predicted ClientSession::predict(const Camera& camera, std::int64_t now_us) {
  const bool was_at_rest = std::exchange(at_rest_, false);
  predictor_.add(now_us, camera.pose);
  const std::int64_t horizon =
      std::min(scheduler_.round_trip_us() + kHorizonSlackUs, kMaxHorizonUs);
  predictor_.remember(horizon);
  const bool relit = relight_.relight(now_us);
  cache_.want_relit(relit);
  Predicted out;
  SelectorInput& input = out.input;
  input.scene = &scene_;
  input.cache = &cache_;
  input.mesh_ready = &meshes_.ready();
  input.meshes = &meshes_;
  input.view = views_.fit();
  input.tile_bytes = &scheduler_.tile_bytes();
  input.camera = input.predicted = camera;
  input.predicted.pose = predictor_.predict(horizon);
  input.velocity = predictor_.velocity_mps();
  input.plan = &plan_;
  const TauLoad load{scheduler_.rate_mbps(), scheduler_.saturated_s(now_us)};
  input.tau_px = tau_.update(load, now_us, scheduler_.round_trip_us());
  input.target_px = options_.tau_px;
  input.method = options_.method;
  input.march_budget_px = options_.march_budget_px;
  input.mesh_radii = options_.mesh_radii;
  if (options_.animation) time_s_ = static_cast<double>(now_us) * 1e-6;
  input.time_s = time_s_;
  input.lead_s = options_.animation ? static_cast<double>(scheduler_.round_trip_us()) * 1e-6 : 0;
  input.horizon_s = options_.animation ? static_cast<double>(horizon) * 1e-6 : 0;
  input.frame = frame_;
  input.now_us = now_us;
  // In time relit tiles give way to better ones, and tau comes down again.
  out.passing = relit && options_.relight == RelightChoice::kAuto;
  out.stands = glm::length(input.predicted.pose.eye - camera.pose.eye) < kStandsM &&
               glm::dot(input.predicted.pose.rotation, camera.pose.rotation) > kFacesSame;
  rested_ = out.stands && (rested_ || was_at_rest);
  input.mesh_tau_px = input.tau_px * (rested_ ? kRestTauShare : 1);
  return out;
}

// Plan: what is drawn. What was touched is in use.
DrawList ClientSession::plan(const SelectorInput& input) {
  DrawList list = selector_.select(input);
  cache_.mark_drawn(list.tiles(), frame_);
  meshes_.mark_drawn(scene_, frame_, input.now_us, list.meshes);
  return list;
}

// Ask: what is missing.
ClientSession::Needs ClientSession::ask(const SelectorInput& input) {
  Needs out;
  out.tiles = selector_.needs(input);
  if (scene_.geometry) {
    out.meshes = meshes_.needs(scene_, input.mesh_tau_px, input.now_us,
                               mesh_wants(scene_, input.predicted, input.mesh_tau_px,
                                          selector_.mesh_needs(input), input.view));
  }
  for (const AssetId& gone : meshes_.drop(frame_, input.now_us)) {
    if (sink_.drop) sink_.drop(gone);
  }
  return out;
}

// Send: as much of it as link and server take now.
void ClientSession::send(const Predicted& at, const DrawList& list, Needs needs) {
  const SelectorInput& input = at.input;
  const std::int64_t now_us = input.now_us;
  if (auto view = views_.plan(scene_, input.predicted, time_s_, list, now_us)) {
    view->request_id = scheduler_.next_number();
    view->lighting_id = lighting_id_;
    views_.asked(view->request_id);
    link_.send(encode_message(std::move(*view)));
  }
  if (shadowed()) shadows_.add_needs(input, lighting_, list, needs.tiles);
  codec_ = codec_choice_.update({scheduler_.rate_mbps(), scheduler_.saturated_s(now_us)}, now_us);
  scheduler_.ask_lossy(is_lossy(codec_));
  std::optional<wire::RequestBatchT> batch =
      scheduler_.plan(scene_, needs.tiles, needs.meshes, lighting_id_, now_us);
  at_rest_ = at.stands && !at.passing && !(moves_ && options_.animation) && needs.tiles.empty() &&
             needs.meshes.empty() && !batch && scheduler_.in_flight() == 0 && uploads_.empty() &&
             input.tau_px <= options_.tau_px;
  if (batch && codec_ != codec_choice_.unasked()) batch->codec = static_cast<std::uint8_t>(codec_);
  if (batch) link_.send(encode_message(std::move(*batch)));
  if (std::optional<wire::OpenRequestT> open = opener_.plan(input)) {
    at_rest_ = false;
    open->request_id = scheduler_.next_number();
    link_.send(encode_message(std::move(*open)));
  }
}

DrawList ClientSession::frame(const Camera& camera, std::int64_t told_us) {
  const std::int64_t now_us = steady_us(told_us);
  ++frame_;
  scheduler_.note_frame(now_us);
  if (!scene_.complete()) {
    at_rest_ = false;
    DrawList first;
    views_.show_all(first);
    return first;
  }
  const Predicted at = predict(camera, now_us);
  DrawList list = plan(at.input);
  if (shadowed()) shadows_.shade(at.input, lighting_, meshes_, list);
  note_first_drawn(now_us);
  Needs needs = ask(at.input);
  views_.show_missing(scene_, camera, list);
  if (link_.connected()) send(at, list, std::move(needs));
  return list;
}

void ClientSession::note_first_drawn(std::int64_t now_us) {
  const auto done = [&](const Undrawn& one) {
    const TileRecordPtr record = one.tile.lock();
    if (record && record->shown) {
      ++drawn_;
      trace_.first_in_frame(one.life, now_us);
    }
    return !record || record->shown;
  };
  undrawn_.erase(std::remove_if(undrawn_.begin(), undrawn_.end(), done), undrawn_.end());
}

TileCounts ClientSession::tiles() const {
  TileCounts counts;
  counts.asked = scheduler_.asked();
  counts.received = received_;
  counts.drawn = drawn_;
  counts.wasted = received_ - drawn_;
  counts.cancelled = scheduler_.cancelled();
  counts.refused = refused_;
  return counts;
}

}  // namespace mirage
