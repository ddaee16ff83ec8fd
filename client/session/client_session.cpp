#include "client/session/client_session.h"

#include <algorithm>
#include <utility>

#include "client/frame/draw_list.h"
#include "client/frame/planned_frame.h"
#include "client/plan/selector_input.h"
#include "client/session/arrivals.h"
#include "client/session/frame_stages.h"
#include "client/session/session_parts.h"
#include "protocol/base/limits.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/view_codec.h"

namespace mirage {
namespace {

// Longest wait for a picture of a new scene, while one of the former scene is shown.
constexpr std::int64_t kLongestAwaitedUs = 3'000'000;

void note_new_scene(SessionParts& s, const DrawList& list, std::int64_t now_us) {
  if (!s.new_scene.awaited) return;
  const auto bare = [](const DrawnPlaceholder& one) { return !one.covered; };
  const bool whole =
      s.scene.complete() && std::none_of(list.placeholders.begin(), list.placeholders.end(), bare);
  const bool shown = list.view || whole;
  if (shown || now_us - s.new_scene.since_us > kLongestAwaitedUs) s.new_scene.awaited = false;
}

void greet(SessionParts& s, std::int64_t now_us) {
  s.connection.greeted_us = now_us;
  s.connection.generation = s.link.generation();
  s.connection.goodbye.clear();
  s.asking.scheduler.reset();
  s.asking.opener.reset();
  s.asking.answered.reset();
  s.asking.catalogue.reset();
  s.asking.ground.reset();
  s.held.uploads.clear();
  wire::HelloT hello;
  hello.version_min = hello.version_max = limits::kProtocolVersion;
  hello.token = s.token;
  hello.name = s.options.name;
  hello.clip = s.choice.clip;
  hello.variant = s.choice.variant;
  hello.codecs = every_codec();
  s.held.views.reset();
  // A client with a light of its own has to tell the server about it first, so it asks for no view
  // yet.
  if (s.held.views.enabled() && !s.light.own && !s.scene.complete()) {
    Camera first = s.options.screen;
    if (s.start) first.pose = *s.start;
    hello.view = std::make_unique<wire::ViewRequestT>(view_request(first, 0));
    hello.view->home = !s.start;
    hello.view->request_id = s.asking.scheduler.next_number();
    s.held.views.asked(hello.view->request_id);
  }
  s.link.send(encode_message(std::move(hello)));
}

}  // namespace

void SessionParts::send_lighting() {
  wire::SetLightingT message;
  message.id = ++light.id;
  message.lighting = to_wire(light.now);
  link.send(encode_message(std::move(message)));
}

ClientSession::ClientSession(Link& link, ClientOptions options, TileSink sink)
    : parts_(std::make_unique<SessionParts>(link, std::move(options), std::move(sink))),
      arrivals_(std::make_unique<Arrivals>(*parts_)) {}

ClientSession::~ClientSession() = default;

Result<void> ClientSession::receive(std::int64_t told_us) {
  SessionParts& s = *parts_;
  const std::int64_t now_us = s.clock.at(told_us);
  if (s.link.connected() && s.link.generation() != s.connection.generation) greet(s, now_us);
  return arrivals_->take(now_us);
}

std::vector<PlannedFrame> ClientSession::frame(const std::vector<Camera>& views,
                                               std::int64_t told_us) {
  std::vector<DrawList> lists = plan_lists(views, parts_->clock.at(told_us));
  std::vector<PlannedFrame> out(views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    out[i].camera = views[i];
    out[i].list = std::move(lists[i]);
    out[i].scene = &parts_->scene;
    out[i].lighting = lighting();
    out[i].setting = plan().setting();
    out[i].tau_px = tau_px();
  }
  return out;
}

PlannedFrame ClientSession::frame(const Camera& camera, std::int64_t told_us) {
  return std::move(frame(std::vector<Camera>{camera}, told_us).front());
}

std::vector<DrawList> ClientSession::plan_lists(const std::vector<Camera>& views,
                                                std::int64_t now_us) {
  SessionParts& s = *parts_;
  ++s.frame;
  s.camera = views.front();
  s.asking.scheduler.note_frame(now_us);
  if (!s.scene.complete()) {
    s.planning.at_rest = false;
    DrawList first;
    s.held.views.show_all(first);
    note_new_scene(s, first, now_us);
    return std::vector<DrawList>(views.size(), first);
  }
  const Predicted at = predict(s, views, now_us);
  s.scene.move_to(s.time_s);
  std::vector<DrawList> lists = mirage::plan(s, at);
  for (std::size_t i = 0; s.shadowed() && i < lists.size(); ++i) {
    s.held.shadows.shade(at.views[i], s.light.now, s.held.meshes, lists[i]);
  }
  s.tally.note_first_drawn(now_us);
  // Answers to this frame's asks arrive a round trip later.
  s.scene.move_to(s.time_s + at.views.front().lead_s);
  Needs needs = ask(s, at);
  s.scene.move_to(s.time_s);
  for (std::size_t i = 0; i < lists.size(); ++i) {
    s.held.views.show_missing(s.scene, views[i], s.time_s, lists[i]);
  }
  if (s.link.connected()) send(s, at, lists, std::move(needs));
  note_new_scene(s, lists.front(), now_us);
  return lists;
}

void ClientSession::set_token(std::string token) { parts_->token = std::move(token); }

void ClientSession::choose(SceneChoice choice) { parts_->choice = std::move(choice); }

std::uint32_t ClientSession::welcomes() const { return parts_->connection.welcomes; }

void ClientSession::start_at(const Pose& pose) { parts_->start = pose; }

void ClientSession::want_ground(const glm::dvec3& eye, std::int64_t told_us) {
  SessionParts& s = *parts_;
  if (!s.link.connected() || !s.scene.complete()) return;
  const std::int64_t now_us = s.clock.at(told_us);
  for (const GroundBlockId& block : s.asking.ground.plan(s.held.ground, eye.x, eye.z, now_us)) {
    wire::GroundRequestT request;
    request.request_id = s.asking.scheduler.next_number();
    request.x = block.x;
    request.z = block.z;
    s.asking.ground.asked(request.request_id, block);
    s.link.send(encode_message(std::move(request)));
  }
}

const GroundMap& ClientSession::ground() const { return parts_->held.ground; }

void ClientSession::play(bool playing, std::int64_t told_us) {
  parts_->playback.play(playing, parts_->clock.at(told_us));
}

bool ClientSession::playing() const { return parts_->playback.playing(); }

bool ClientSession::animated() const { return parts_->may_animate(); }

void ClientSession::set_lighting(const Lighting& lighting, std::int64_t told_us) {
  SessionParts& s = *parts_;
  if (s.asking.catalogue.there()) return;
  const std::int64_t now_us = s.clock.at(told_us);
  s.light.own = true;
  s.light.now = lighting;
  if (!s.scene.complete()) return;
  s.send_lighting();
  const LightHistory& lights = s.held.tiles.lights();
  const std::uint32_t before = lights.current().serial;
  const std::uint32_t latest = lights.latest_serial();
  s.held.tiles.relight(s.light.now, now_us);
  s.held.shadows.relight(now_us);
  s.light.changed = s.light.changed || lights.current().serial != before;
  if (lights.latest_serial() != latest) s.held.relight.new_light(now_us);
}

void ClientSession::ask_reference(const Camera& camera, std::uint32_t supersample) {
  SessionParts& s = *parts_;
  wire::ReferenceRequestT request;
  request.request_id = 0;
  request.lighting_id = s.light.id;
  request.eye = std::make_unique<wire::Vec3d>(to_wire(camera.pose.eye));
  request.rotation = std::make_unique<wire::Quat>(to_wire(camera.pose.rotation));
  request.fov_y = camera.fov_y;
  request.width = camera.width;
  request.height = camera.height;
  request.shift_x = camera.shift_px.x;
  request.shift_y = camera.shift_px.y;
  request.pixel_aspect = camera.pixel_aspect;
  request.supersample = supersample;
  request.time_s = s.time_s;
  s.reference.refused = false;
  s.reference.asked_px = std::size_t{camera.width} * camera.height;
  s.link.send(encode_message(std::move(request)));
}

TileCounts ClientSession::tiles() const {
  const SessionParts& s = *parts_;
  TileCounts counts;
  counts.asked = s.asking.scheduler.asked();
  counts.received = s.tally.received;
  counts.drawn = s.tally.drawn;
  counts.wasted = s.tally.received - s.tally.drawn;
  counts.cancelled = s.asking.scheduler.cancelled();
  counts.refused = s.tally.refused;
  return counts;
}

void ClientSession::set_prices(const CostModel& prices) {
  parts_->planning.plan.set_prices(prices);
}
void ClientSession::set_frame_ms(double ms) { parts_->planning.plan.set_budget(ms); }

void ClientSession::note_frame_ms(double ms, double beside_ms) {
  parts_->planning.plan.note_drawn(ms, beside_ms);
}
const FramePlan& ClientSession::plan() const { return parts_->planning.plan; }
const std::vector<Alternatives>& ClientSession::considered() const {
  return parts_->planning.things;
}
double ClientSession::tau_px() const { return parts_->planning.tau.tau_px(); }
bool ClientSession::at_rest() const { return parts_->planning.at_rest; }
const Predictor& ClientSession::predictor() const { return parts_->planning.eyes[0].predictor; }
const Lighting& ClientSession::lighting() const { return parts_->light.now; }
bool ClientSession::frozen() const { return parts_->asking.catalogue.there(); }
bool ClientSession::light_changed() const { return parts_->light.changed; }
std::optional<ReferenceFrame> ClientSession::take_reference() {
  return std::exchange(parts_->reference.frame, std::nullopt);
}
bool ClientSession::reference_refused() const { return parts_->reference.refused; }
const SceneView& ClientSession::scene() const { return parts_->scene; }
const CodecUses& ClientSession::codecs() const { return parts_->tally.codecs(); }
TileCodec ClientSession::codec() const { return parts_->asking.codec; }
const UploadCounts& ClientSession::uploads() const { return parts_->held.uploads.counts(); }
const std::vector<TileLife>& ClientSession::lives() const { return parts_->tally.trace.lives(); }
void ClientSession::note_drawn(std::int64_t now_us) { parts_->tally.trace.frame_drawn(now_us); }
const ViewCounts& ClientSession::views() const { return parts_->held.views.counts(); }
bool ClientSession::drawable() const {
  const SessionParts& s = *parts_;
  return s.scene.complete() || (s.scene.welcomed() && s.held.views.here());
}
bool ClientSession::awaits_new_scene() const { return parts_->new_scene.awaited; }
std::int64_t ClientSession::round_trip_us() const {
  return parts_->asking.scheduler.round_trip_us();
}
bool ClientSession::first_waits() const { return parts_->asking.scheduler.first_waits(); }
std::size_t ClientSession::in_flight() const { return parts_->asking.scheduler.in_flight(); }
std::uint64_t ClientSession::frame_number() const { return parts_->frame; }
const std::string& ClientSession::goodbye() const { return parts_->connection.goodbye; }

}  // namespace mirage
