#include "client/session/frame_stages.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "client/frame/draw_list.h"
#include "client/plan/mesh_wants.h"
#include "client/plan/selector.h"
#include "client/session/session_parts.h"

namespace mirage {
namespace {
// Asks look this far beyond the round trip: half of a tile's expected life.
constexpr std::int64_t kHorizonSlackUs = 150'000;
constexpr std::int64_t kMaxHorizonUs = 1'000'000;
constexpr double kStandsM = 1e-6;  // between the eye and where it is expected to be
// Geometry at rest is drawn for this share of tau, because nothing else is left to ask for.
constexpr double kRestTauShare = 0.25;
constexpr float kFacesSame = 0.999999f;  // cosine of half the angle: 0.16 degrees

/// Returns the part of the input that all views of a frame share.
SelectorInput shared_input(SessionParts& s, std::int64_t horizon_us, std::int64_t now_us) {
  SelectorInput input;
  input.scene = &s.scene;
  input.cache = &s.held.tiles;
  input.mesh_ready = &s.held.meshes.ready();
  input.meshes = &s.held.meshes;
  input.view = s.held.views.fit();
  input.tile_bytes = &s.asking.scheduler.tile_bytes();
  input.spare_bytes = s.asking.scheduler.spare_bytes();
  input.plan = &s.planning.plan;
  const TauLoad load{s.asking.scheduler.rate_mbps(), s.asking.scheduler.saturated_s(now_us)};
  input.tau_px = s.planning.tau.update(load, now_us, s.asking.scheduler.round_trip_us());
  input.target_px = s.options.tau_px;
  input.method = s.options.method;
  input.march_budget_px = s.options.march_budget_px;
  input.mesh_radii = s.options.mesh_radii;
  // A folder has few tiles of a thing: geometry is right where they are not.
  input.geometry_first = s.options.geometry_first || s.asking.catalogue.there();
  const bool still = !s.options.animation || s.asking.catalogue.there();
  if (!still) s.time_s = s.playback.at(now_us);
  input.time_s = s.time_s;
  const bool plays = !still && s.playback.playing();
  input.lead_s = plays ? static_cast<double>(s.asking.scheduler.round_trip_us()) * 1e-6 : 0;
  input.horizon_s = plays ? static_cast<double>(horizon_us) * 1e-6 : 0;
  input.frame = s.frame;
  input.now_us = now_us;
  return input;
}

/// Adds what is of one view. Returns true if its eye stays where it is.
bool predict_eye(Eye& eye, const Camera& camera, std::int64_t horizon_us, SelectorInput& input) {
  eye.predictor.add(input.now_us, camera.pose);
  eye.predictor.remember(horizon_us);
  input.camera = input.predicted = camera;
  input.predicted.pose = eye.predictor.predict(horizon_us);
  input.velocity = eye.predictor.velocity_mps();
  return glm::length(input.predicted.pose.eye - camera.pose.eye) < kStandsM &&
         glm::dot(input.predicted.pose.rotation, camera.pose.rotation) > kFacesSame;
}

}  // namespace

Predicted predict(SessionParts& s, const std::vector<Camera>& views, std::int64_t now_us) {
  const bool was_at_rest = std::exchange(s.planning.at_rest, false);
  s.planning.eyes.resize(views.size(), s.scene);
  const std::int64_t horizon =
      std::min(s.asking.scheduler.round_trip_us() + kHorizonSlackUs, kMaxHorizonUs);
  const bool relit = s.held.relight.relight(now_us);
  s.held.tiles.want_relit(relit);
  Predicted out;
  // Relit tiles of the automatic choice give way to better ones in time, and tau comes down again.
  out.passing = relit && s.options.relight == RelightChoice::kAuto;
  out.stands = true;
  out.views.assign(views.size(), shared_input(s, horizon, now_us));
  const double scale = s.planning.plan.setting().scale;
  for (std::size_t i = 0; i < views.size(); ++i) {
    Eye& eye = s.planning.eyes[i];
    SelectorInput& input = out.views[i];
    const bool stands = predict_eye(eye, views[i], horizon, input);
    eye.rested = stands && (eye.rested || was_at_rest);
    input.pixel_px = eye.drawn_pixel.update(scale, stands, now_us);
    input.mesh_tau_px = input.tau_px * (eye.rested ? kRestTauShare : 1);
    out.stands = out.stands && stands;
  }
  s.planning.plan.stand(out.stands && !s.animates(), now_us);
  return out;
}

std::vector<DrawList> plan(SessionParts& s, const Predicted& at) {
  std::vector<Alternatives>& things = s.planning.things;
  things.clear();
  std::vector<Camera> cameras;
  std::vector<std::size_t> first;  // thing of each view
  for (std::size_t i = 0; i < at.views.size(); ++i) {
    cameras.push_back(at.views[i].camera);
    first.push_back(things.size());
    s.planning.eyes[i].selector.consider(at.views[i], things);
  }
  const std::int64_t now_us = at.views.front().now_us;
  const std::vector<Choice>& choices = s.planning.plan.decide(cameras, things, now_us);
  std::vector<DrawList> out;
  for (std::size_t i = 0; i < at.views.size(); ++i) {
    out.push_back(s.planning.eyes[i].selector.draw(at.views[i], choices.data() + first[i]));
    s.held.tiles.mark_drawn(out.back().tiles(), s.frame);
    s.held.meshes.mark_drawn(s.scene, s.frame, now_us, out.back().meshes);
  }
  return out;
}

Needs ask(SessionParts& s, const Predicted& at) {
  Needs out;
  const auto add = [](auto& all, auto&& more) { all.insert(all.end(), more.begin(), more.end()); };
  for (std::size_t i = 0; i < at.views.size(); ++i) {
    const SelectorInput& input = at.views[i];
    Selector& selector = s.planning.eyes[i].selector;
    add(out.tiles, selector.needs(input));
    if (!s.scene.geometry) continue;
    const std::vector<MeshWant> wants = mesh_wants(input, selector.mesh_needs(input));
    add(out.meshes, s.held.meshes.needs(s.scene, input.mesh_tau_px, input.now_us, wants));
  }
  for (const AssetId& gone : s.held.meshes.drop(s.frame, at.views.front().now_us)) {
    if (s.sink.drop) s.sink.drop(gone);
  }
  return out;
}

void send(SessionParts& s, const Predicted& at, const std::vector<DrawList>& lists, Needs needs) {
  const SelectorInput& first = at.views.front();
  const std::int64_t now_us = first.now_us;
  const std::uint32_t light = s.held.tiles.lights().current().serial;
  if (auto view =
          s.held.views.plan(s.scene, first.predicted, s.time_s, light, lists.front(), now_us)) {
    view->request_id = s.asking.scheduler.next_number();
    view->lighting_id = s.light.id;
    s.held.views.asked(view->request_id);
    s.link.send(encode_message(std::move(*view)));
  }
  for (std::size_t i = 0; s.shadowed() && i < lists.size(); ++i) {
    s.held.shadows.add_needs(at.views[i], s.light.now, lists[i], needs.tiles);
  }
  s.asking.catalogue.fit(s.scene, s.held.tiles, needs.tiles);
  s.asking.catalogue.fit(s.held.meshes, needs.meshes);
  s.asking.answered.remove_from(needs.tiles, at.stands, now_us);
  s.asking.codec = s.asking.codec_choice.update(
      {s.asking.scheduler.rate_mbps(), s.asking.scheduler.saturated_s(now_us)}, now_us);
  s.asking.scheduler.ask_lossy(is_lossy(s.asking.codec));
  std::optional<wire::RequestBatchT> batch =
      s.asking.scheduler.plan(s.scene, needs.tiles, needs.meshes, s.light.id, now_us);
  s.planning.at_rest = at.stands && !at.passing && !s.animates() && needs.tiles.empty() &&
                       needs.meshes.empty() && !batch && s.asking.scheduler.in_flight() == 0 &&
                       s.held.uploads.empty() && first.tau_px <= s.options.tau_px;
  if (batch && s.asking.codec != s.asking.codec_choice.unasked())
    batch->codec = static_cast<std::uint8_t>(s.asking.codec);
  if (batch) s.link.send(encode_message(std::move(*batch)));
  for (wire::OpenRequestT& open : s.asking.opener.plan(at.views)) {
    s.planning.at_rest = false;
    open.request_id = s.asking.scheduler.next_number();
    s.link.send(encode_message(std::move(open)));
  }
}

}  // namespace mirage
