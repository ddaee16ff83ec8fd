#include "client/session/frame_stages.h"

#include <algorithm>
#include <optional>
#include <utility>

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
}  // namespace

Predicted predict(SessionParts& s, const Camera& camera, std::int64_t now_us) {
  const bool was_at_rest = std::exchange(s.planning.at_rest, false);
  s.planning.predictor.add(now_us, camera.pose);
  const std::int64_t horizon =
      std::min(s.asking.scheduler.round_trip_us() + kHorizonSlackUs, kMaxHorizonUs);
  s.planning.predictor.remember(horizon);
  const bool relit = s.held.relight.relight(now_us);
  s.held.tiles.want_relit(relit);
  Predicted out;
  SelectorInput& input = out.input;
  input.scene = &s.scene;
  input.cache = &s.held.tiles;
  input.mesh_ready = &s.held.meshes.ready();
  input.meshes = &s.held.meshes;
  input.view = s.held.views.fit();
  input.tile_bytes = &s.asking.scheduler.tile_bytes();
  input.spare_bytes = s.asking.scheduler.spare_bytes();
  input.camera = input.predicted = camera;
  input.predicted.pose = s.planning.predictor.predict(horizon);
  input.velocity = s.planning.predictor.velocity_mps();
  input.plan = &s.planning.plan;
  const TauLoad load{s.asking.scheduler.rate_mbps(), s.asking.scheduler.saturated_s(now_us)};
  input.tau_px = s.planning.tau.update(load, now_us, s.asking.scheduler.round_trip_us());
  input.target_px = s.options.tau_px;
  input.method = s.options.method;
  input.march_budget_px = s.options.march_budget_px;
  input.mesh_radii = s.options.mesh_radii;
  if (s.options.animation) s.time_s = s.playback.at(now_us);
  input.time_s = s.time_s;
  const bool plays = s.options.animation && s.playback.playing();
  input.lead_s = plays ? static_cast<double>(s.asking.scheduler.round_trip_us()) * 1e-6 : 0;
  input.horizon_s = plays ? static_cast<double>(horizon) * 1e-6 : 0;
  input.frame = s.frame;
  input.now_us = now_us;
  // Relit tiles of the automatic choice give way to better ones in time, and tau comes down again.
  out.passing = relit && s.options.relight == RelightChoice::kAuto;
  out.stands = glm::length(input.predicted.pose.eye - camera.pose.eye) < kStandsM &&
               glm::dot(input.predicted.pose.rotation, camera.pose.rotation) > kFacesSame;
  s.planning.plan.stand(out.stands && !s.animates(), now_us);
  s.planning.rested = out.stands && (s.planning.rested || was_at_rest);
  input.pixel_px =
      s.planning.drawn_pixel.update(s.planning.plan.setting().scale, out.stands, now_us);
  input.mesh_tau_px = input.tau_px * (s.planning.rested ? kRestTauShare : 1);
  return out;
}

DrawList plan(SessionParts& s, const SelectorInput& input) {
  DrawList list = s.planning.selector.select(input);
  s.held.tiles.mark_drawn(list.tiles(), s.frame);
  s.held.meshes.mark_drawn(s.scene, s.frame, input.now_us, list.meshes);
  return list;
}

Needs ask(SessionParts& s, const SelectorInput& input) {
  Needs out;
  out.tiles = s.planning.selector.needs(input);
  if (s.scene.geometry) {
    out.meshes = s.held.meshes.needs(
        s.scene, input.mesh_tau_px, input.now_us,
        mesh_wants(s.scene, input.predicted, input.mesh_tau_px,
                   s.planning.selector.mesh_needs(input), input.view, input.time_s));
  }
  for (const AssetId& gone : s.held.meshes.drop(s.frame, input.now_us)) {
    if (s.sink.drop) s.sink.drop(gone);
  }
  return out;
}

void send(SessionParts& s, const Predicted& at, const DrawList& list, Needs needs) {
  const SelectorInput& input = at.input;
  const std::int64_t now_us = input.now_us;
  const std::uint32_t light = s.held.tiles.lights().current().serial;
  if (auto view = s.held.views.plan(s.scene, input.predicted, s.time_s, light, list, now_us)) {
    view->request_id = s.asking.scheduler.next_number();
    view->lighting_id = s.light.id;
    s.held.views.asked(view->request_id);
    s.link.send(encode_message(std::move(*view)));
  }
  if (s.shadowed()) s.held.shadows.add_needs(input, s.light.now, list, needs.tiles);
  s.asking.answered.remove_from(needs.tiles, at.stands, now_us);
  s.asking.codec = s.asking.codec_choice.update(
      {s.asking.scheduler.rate_mbps(), s.asking.scheduler.saturated_s(now_us)}, now_us);
  s.asking.scheduler.ask_lossy(is_lossy(s.asking.codec));
  std::optional<wire::RequestBatchT> batch =
      s.asking.scheduler.plan(s.scene, needs.tiles, needs.meshes, s.light.id, now_us);
  s.planning.at_rest = at.stands && !at.passing && !s.animates() && needs.tiles.empty() &&
                       needs.meshes.empty() && !batch && s.asking.scheduler.in_flight() == 0 &&
                       s.held.uploads.empty() && input.tau_px <= s.options.tau_px;
  if (batch && s.asking.codec != s.asking.codec_choice.unasked())
    batch->codec = static_cast<std::uint8_t>(s.asking.codec);
  if (batch) s.link.send(encode_message(std::move(*batch)));
  if (std::optional<wire::OpenRequestT> open = s.asking.opener.plan(input)) {
    s.planning.at_rest = false;
    open->request_id = s.asking.scheduler.next_number();
    s.link.send(encode_message(std::move(*open)));
  }
}

}  // namespace mirage
