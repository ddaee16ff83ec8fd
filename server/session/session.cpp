#include "server/session/session.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <ctime>

#include "protocol/impostor/tile_key.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/light_probe_codec.h"
#include "server/prepare/prepared_scene.h"
#include "server/scene/scene.h"
#include "server/session/encoded_cache.h"
#include "server/session/hub_state.h"
#include "server/stage/render_profile.h"

namespace mirage {
namespace {

// Memory for encoded parts of the scene.
constexpr std::size_t kImageBytes = 256u << 20, kGroundBytes = 16u << 20;

constexpr std::int64_t kHelloTimeoutUs = 10'000'000;
constexpr std::size_t kMaxHelloBytes = 4096;
// Most connections without a hello. One more closes the oldest of them.
constexpr std::size_t kMaxStrangers = 256;
// Time in which a client must read some of its waiting data.
constexpr std::int64_t kNoProgressUs = 30'000'000;
// Per client; Mirage's own client has one open at a time.
constexpr std::size_t kMaxWaitingOpenRequests = 64;

// Returns the codecs of this server that a client accepts. A client without zstd gets no lossy
// codecs, because tiles without colours are sent lossless.
std::vector<TileCodec> common_codecs(const std::vector<TileCodec>& ours,
                                     const std::vector<std::uint8_t>& theirs) {
  const auto taken = [&](TileCodec codec) {
    return std::find(theirs.begin(), theirs.end(), static_cast<std::uint8_t>(codec)) !=
           theirs.end();
  };
  const bool zstd = taken(TileCodec::kZstd);
  std::vector<TileCodec> out;
  for (const TileCodec codec : ours) {
    if (taken(codec) && (zstd || !is_lossy(codec))) out.push_back(codec);
  }
  return out;
}

void tell_home(const HomeView& home, wire::WelcomeT& welcome) {
  welcome.home_eye = std::make_unique<wire::Vec3d>(to_wire(home.eye));
  welcome.home_target = std::make_unique<wire::Vec3d>(to_wire(home.target));
  for (const glm::vec3& point : home.fit) welcome.home_fit.push_back(to_wire(point));
  welcome.walk_radius_m = home.walk_radius_m;
  welcome.walk_speed_mps = home.walk_speed_mps;
  welcome.walk_eye_m = home.walk_eye_m;
}

std::unique_ptr<wire::StudioFloorT> floor_to_wire(const StudioFloor& floor) {
  if (!(floor.half > 0)) return nullptr;
  auto out = std::make_unique<wire::StudioFloorT>();
  out->center = std::make_unique<wire::Vec3d>(to_wire(floor.center));
  out->half = floor.half;
  out->color = std::make_unique<wire::Vec3f>(to_wire(floor.color));
  out->shadow = floor.shadow;
  return out;
}

}  // namespace

SessionHub::SessionHub(std::shared_ptr<const PreparedScene> scene, SessionOptions options,
                       StageQueues& queues)
    : scene_(std::move(scene)),
      options_(std::move(options)),
      access_(options_.access),
      revision_(profiled_revision(scene_->revision, options_.profile)),
      clock_(queues.clock),
      counters_(queues.counters),
      queue_(queues.tiles),
      store_(queues.store),
      pages_(queue_.waits_for_levels() ? std::vector<PacketPtr>{} : make_scene_pages(*scene_)),
      probe_page_(scene_->scene.probe ? encode_probe(*scene_->scene.probe) : Bytes{}),
      pixels_(queues.rendered),
      parts_(new EncodedParts{{queues.images, kImageBytes}, {queues.grounds, kGroundBytes}}),
      fetches_(queues.fetches, queues.clock, queues.store.patience_us()),
      forms_(queues.rendered),
      views_(queues.tiles),
      pictures_(queues.tiles) {}

SessionHub::~SessionHub() = default;

SessionId SessionHub::open() {
  const SessionId id = next_id_++;
  Session& s = sessions_.try_emplace(id, options_.max_outbox_bytes).first->second;
  s.opened_us = s.progress_us = clock_.now_us();
  return id;
}

void SessionHub::close(SessionId id) {
  queue_.remove_session(id);
  fetches_.remove_session(id);
  views_.remove_session(id);
  forms_.remove_session(id);
  parts_->images.remove_session(id);
  parts_->grounds.remove_session(id);
  if (sessions_.at(id).greeted) --clients_;
  sessions_.erase(id);
  writable_.erase(id);
}

std::size_t SessionHub::asks_of(SessionId id) const {
  return queue_.asks_of(id) + fetches_.asks_of(id) + views_.asks_of(id) + forms_.asks_of(id) +
         parts_->images.asks_of(id) + parts_->grounds.asks_of(id);
}

Result<void> SessionHub::receive(SessionId id, const std::uint8_t* bytes, std::size_t size) {
  counters_.bytes_received += size;
  Session& s = sessions_.at(id);
  if (!s.greeted && size > kMaxHelloBytes) {
    return make_error(ErrorId::kWireLimit, "a hello has at most 4096 bytes");
  }
  Result<std::optional<Bytes>> whole = s.assembler.accept(bytes, size);
  if (!whole) return whole.error();
  if (!whole->has_value() && !s.greeted) {
    return make_error(ErrorId::kWireState, "the first message must be a hello, in one piece");
  }
  if (!whole->has_value()) return {};
  Result<Message> message = decode_message((*whole)->data(), (*whole)->size());
  if (!message) return message.error();
  return handle(id, s, message.take());
}

Result<void> SessionHub::handle(SessionId id, Session& s, Message message) {
  wire::BodyUnion& body = message.body;
  if (!s.greeted && body.type != wire::Body::Hello) {
    return make_error(ErrorId::kWireState, "the first message must be a hello");
  }
  switch (body.type) {
    case wire::Body::Hello:
      return hello(id, s, *body.AsHello());
    case wire::Body::SetLighting:
      return set_lighting(s, *body.AsSetLighting());
    case wire::Body::RequestBatch:
      batch(id, s, *body.AsRequestBatch());
      return {};
    case wire::Body::OpenRequest:
      open_groups(id, s, *body.AsOpenRequest());
      return {};
    case wire::Body::ReferenceRequest:
      reference(id, s, *body.AsReferenceRequest());
      return {};
    case wire::Body::ViewRequest:
      view(id, s, *body.AsViewRequest());
      return {};
    case wire::Body::GroundRequest:
      ground(id, s, *body.AsGroundRequest());
      return {};
    case wire::Body::StatsRequest:
      stats(id, *body.AsStatsRequest());
      return {};
    case wire::Body::Bye:
      return make_error(ErrorId::kNetworkClosed, "client said goodbye");
    default:
      return make_error(ErrorId::kWireState, "this message is not for a server");
  }
}

Result<Grant> SessionHub::admit(const wire::HelloT& hello) {
  if (hello.version_min > limits::kProtocolVersion ||
      hello.version_max < limits::kProtocolVersion) {
    return make_error(ErrorId::kWireVersion,
                      "client speaks protocol " + std::to_string(hello.version_min) + " to " +
                          std::to_string(hello.version_max) + ", this server " +
                          std::to_string(limits::kProtocolVersion));
  }
  Result<Grant> grant = access_.check(hello.token, std::time(nullptr));
  if (!grant) {
    ++counters_.authentication_failures;
    return grant.error();
  }
  if (clients_ + clients_elsewhere_ >= options_.max_clients || draining_) {
    return make_error(ErrorId::kBusy,
                      draining_
                          ? "server is shutting down"
                          : "server has its " + std::to_string(options_.max_clients) + " clients");
  }
  return grant;
}

Result<void> SessionHub::hello(SessionId id, Session& s, const wire::HelloT& hello) {
  if (s.greeted) return make_error(ErrorId::kWireState, "a second hello");
  Result<Grant> grant = admit(hello);
  if (!grant) return grant.error();
  s.codecs = common_codecs(options_.codecs, hello.codecs);
  if (s.codecs.empty()) {
    return make_error(ErrorId::kCodec, "client does not decode this server's tile codecs");
  }
  if (options_.choices) {
    s.elsewhere = other_choice(scene_->scene.choices, {hello.clip, hello.variant});
    if (s.elsewhere) return {};
  }
  s.grant = grant.take();
  s.greeted = true;
  ++clients_;
  const Scene& scene = scene_->scene;
  wire::WelcomeT welcome;
  welcome.version = limits::kProtocolVersion;
  welcome.codec = static_cast<std::uint8_t>(s.codecs.front());
  for (const TileCodec codec : s.codecs) {
    welcome.codecs.push_back(static_cast<std::uint8_t>(codec));
  }
  welcome.tile_us = static_cast<std::uint32_t>(std::lround(std::min(tile_us_, 1e9)));
  welcome.revision = revision_;
  welcome.scene = scene.name.substr(0, limits::kMaxTextBytes);
  welcome.renderer = options_.renderer.substr(0, limits::kMaxTextBytes);
  welcome.objects = static_cast<std::uint32_t>(scene.objects.size());
  welcome.instances = static_cast<std::uint32_t>(scene.instances.size());
  welcome.groups = static_cast<std::uint32_t>(scene_->grouping.groups.size());
  welcome.roots = static_cast<std::uint32_t>(scene_->grouping.roots.size());
  welcome.bounds_center = std::make_unique<wire::Vec3d>(to_wire(scene_->bounds_center));
  welcome.bounds_radius = scene_->bounds_radius;
  welcome.triangles = scene.triangles();
  welcome.lighting = to_wire(scene.lighting);
  welcome.sky_zenith = std::make_unique<wire::Vec3f>(to_wire(scene.environment.zenith));
  welcome.sky_horizon = std::make_unique<wire::Vec3f>(to_wire(scene.environment.horizon));
  welcome.sky_nadir = std::make_unique<wire::Vec3f>(to_wire(scene.environment.nadir));
  welcome.fog_density = scene.environment.fog_density;
  tell_home(scene.home, welcome);
  welcome.tone = static_cast<std::uint8_t>(scene.environment.tone);
  welcome.floor = floor_to_wire(scene.environment.floor);
  welcome.geometry = options_.geometry && s.grant.geometry;
  welcome.reference = options_.reference && s.grant.reference;
  welcome.shadows = options_.shadows;
  welcome.images = static_cast<std::uint32_t>(scene.images.size());
  if (options_.choices) {
    welcome.clips = scene.choices.clips;
    welcome.variants = scene.choices.variants;
  }
  welcome.clip = scene.choices.shown.clip;
  welcome.variant = scene.choices.shown.variant;
  push(id, Outbox::Lane::kControl, encode_message(std::move(welcome)));
  if (!probe_page_.empty()) push(id, Outbox::Lane::kControl, probe_page_);
  if (hello.view) view(id, s, *hello.view);
  return {};
}

void SessionHub::open_groups(SessionId id, Session& s, const wire::OpenRequestT& m) {
  if (s.tree.size() >= kMaxWaitingOpenRequests) {
    s.hopeless = true;
    return;
  }
  begin_waiting(s);
  s.tree.emplace_back(*scene_, m);
  writable_.insert(id);
}

Result<void> SessionHub::set_lighting(Session& s, const wire::SetLightingT& m) {
  if (m.id == 0) return make_error(ErrorId::kWireValue, "lighting 0 is the scene's own");
  if (s.lighting.count(m.id) == 0 && s.lighting.size() >= limits::kMaxLightingStatesPerClient) {
    s.lighting.erase(s.lighting.begin());  // the lowest id is the oldest: ids only grow
  }
  Result<Lighting> lighting = from_wire(*m.lighting);
  if (!lighting) return lighting.error();
  const std::uint64_t probe = lighting->probe.id;
  if (probe != 0 && probe != scene_->scene.lighting.probe.id) {
    return make_error(ErrorId::kWireValue, "lighting has a probe that is not this scene's");
  }
  s.lighting[m.id] = lighting.take();
  return {};
}

void SessionHub::batch(SessionId id, Session& s, const wire::RequestBatchT& batch) {
  begin_waiting(s);
  s.outbox.allow(batch.credit_bytes);
  for (const std::uint32_t request : batch.cancels) {
    if (fetches_.cancel(id, request)) {
      ++counters_.tiles_cancelled;
    } else {
      queue_.cancel(id, request);
    }
  }
  const auto found = s.lighting.find(batch.lighting_id);
  const bool known = batch.lighting_id == 0 || found != s.lighting.end();
  const Lighting& lighting = found != s.lighting.end() ? found->second : scene_->scene.lighting;
  const auto asked = static_cast<TileCodec>(batch.codec);
  const bool common = std::find(s.codecs.begin(), s.codecs.end(), asked) != s.codecs.end();
  const TileCodec codec = common ? asked : s.codecs.front();
  for (const wire::Ask& one : batch.asks) {
    ++counters_.tiles_asked;
    if (known) {
      ask(id, one, lighting, codec);
    } else {
      refuse(id, one.request_id(), wire::RefusalReason::BadKey);
    }
  }
  for (const wire::MeshAsk& one : batch.mesh_asks) mesh_ask(id, s, one);
  for (const wire::ImageAsk& one : batch.image_asks) image_ask(id, s, one);
  writable_.insert(id);  // new credit may release waiting tiles
}

void SessionHub::refuse(SessionId id, std::uint32_t request, wire::RefusalReason reason) {
  ++counters_.tiles_refused;
  ++counters_.refused_for[std::min<std::size_t>(static_cast<std::size_t>(reason),
                                                counters_.refused_for.size() - 1)];
  if (id == kGetters) return got_.push_back({request, {}, 0, reason});
  wire::RefusedT refused;
  refused.request_id = request;
  refused.reason = reason;
  push(id, Outbox::Lane::kControl, encode_message(refused));
}

void SessionHub::refuse_late() {
  for (const Waiter& w : queue_.take_late()) {
    if (waits_still(w.session)) refuse(w.session, w.request_id, wire::RefusalReason::Late);
  }
}

bool SessionHub::waits(const Session& s) const {
  const bool told = !s.greeted || s.next_page == pages_.size();
  return !told || s.outbox.ready() || !s.meshes.empty() || !s.tree.empty();
}

void SessionHub::begin_waiting(Session& s) const {
  if (!waits(s)) s.progress_us = clock_.now_us();
}

void SessionHub::push(SessionId id, Outbox::Lane lane, Bytes message) {
  Session& s = sessions_.at(id);
  if (s.hopeless) return;
  begin_waiting(s);
  s.outbox.push(lane, std::move(message));
  s.hopeless = s.outbox.hopeless();
  writable_.insert(id);
}

void SessionHub::complete(Completion completion) {
  std::visit([this](auto& done) { finish(std::move(done)); }, completion);
}

void SessionHub::finish(TooLargeTile done) {
  for (const Waiter& w : queue_.finish(done.id)) {
    if (waits_still(w.session)) refuse(w.session, w.request_id, wire::RefusalReason::TooLarge);
  }
}

void SessionHub::finish(FinishedReference done) {
  const auto at = sessions_.find(done.session);
  if (at == sessions_.end()) return;
  at->second.full_render = Session::FullRender::kSending;
  push(done.session, Outbox::Lane::kLarge, std::move(done.message));
}

void SessionHub::finish(LevelsMade) {
  for (auto& [id, s] : sessions_) {
    begin_waiting(s);
    if (s.greeted) writable_.insert(id);
  }
  pages_ = make_scene_pages(*scene_);
}

PacketPtr SessionHub::next_tree_page(Session& s) {
  while (!s.tree.empty()) {
    if (PacketPtr page = s.tree.front().next_page()) return page;
    s.tree.pop_front();
  }
  return nullptr;
}

PacketPtr SessionHub::next_packet(SessionId id) {
  Session& s = sessions_.at(id);
  PacketPtr packet = s.outbox.next_control();
  if (!packet && s.greeted && s.next_page < pages_.size()) packet = pages_[s.next_page++];
  if (!packet) packet = next_tree_page(s);
  if (!packet && !s.outbox.large_waits() && !s.meshes.empty()) push_mesh(id, s);
  if (!packet) packet = s.outbox.next_tile_or_bulk();
  if (!packet) return nullptr;
  if (s.full_render == Session::FullRender::kSending && !s.outbox.large_waits()) {
    s.full_render = Session::FullRender::kNone;
  }
  s.progress_us = clock_.now_us();
  counters_.bytes_sent += packet->size();
  return packet;
}

std::set<SessionId> SessionHub::take_writable() { return std::exchange(writable_, {}); }

std::vector<std::pair<SessionId, Error>> SessionHub::overdue() {
  std::vector<std::pair<SessionId, Error>> out;
  const std::int64_t now = clock_.now_us();
  std::size_t strangers = sessions_.size() - clients_;
  for (const auto& [id, s] : sessions_) {  // in order of arrival
    const bool stranger = !s.greeted && !s.elsewhere;
    const bool crowded = stranger && strangers > kMaxStrangers;
    if (crowded) --strangers;
    if (crowded || (stranger && now - s.opened_us > kHelloTimeoutUs)) {
      out.emplace_back(id, make_error(ErrorId::kNetworkTimeout,
                                      crowded ? "no hello yet, and many wait to say theirs"
                                              : "no hello within 10 s"));
    } else if (s.hopeless || (waits(s) && now - s.progress_us > kNoProgressUs)) {
      out.emplace_back(id, make_error(ErrorId::kBusy, "client does not read what it asked for"));
    }
  }
  return out;
}

void SessionHub::say_goodbye_to_all(const std::string& text) {
  for (auto& [id, s] : sessions_) {
    wire::ByeT bye;
    bye.text = text;
    push(id, Outbox::Lane::kControl, encode_message(std::move(bye)));
  }
}

bool SessionHub::drained() const {
  const bool sent = std::none_of(sessions_.begin(), sessions_.end(), [](const auto& entry) {
    return entry.second.outbox.ready() || !entry.second.meshes.empty();
  });
  return sent && queue_.length() == 0 && !forms_.waiting() && !fetches_.waiting() &&
         pictures_.under_way() == 0;
}

HubState SessionHub::state() const {
  HubState out;
  out.clients = clients_;
  out.strangers = sessions_.size() - clients_;
  for (const auto& [id, s] : sessions_) {
    out.outbox_bytes += s.outbox.bytes();
    out.largest_outbox_bytes = std::max(out.largest_outbox_bytes, s.outbox.bytes());
  }
  out.tiles_queued = queue_.length();
  out.pixels_bytes = pixels_.weighs();
  out.draining = draining_;
  return out;
}

std::string SessionHub::identity(bool draining) const {
  char text[128];
  std::snprintf(text, sizeof(text),
                R"({"revision":"%016)" PRIx64 R"(","profile":"%016)" PRIx64 R"(","draining":%s})"
                "\n",
                revision_, options_.profile, draining ? "true" : "false");
  return text;
}

}  // namespace mirage
