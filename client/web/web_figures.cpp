#include "client/web/web_figures.h"

#include <cmath>
#include <cstdio>

#include "client/door/client.h"
#include "client/draw/frame_renderer.h"
#include "client/frame/planned_frame.h"
#include "client/hold/tile_cache.h"
#include "client/link/link.h"
#include "client/plan/frame_plan.h"
#include "client/scene/scene_view.h"
#include "client/screen/screen.h"
#include "client/session/client_session.h"
#include "protocol/base/quantile.h"
#include "shaders/gl/renderer.h"

namespace mirage {

std::string web_figures(const Client& client, const LinkTraffic& traffic,
                        std::uint64_t drawn_frames, std::int64_t now_us) {
  const ClientSession& session = client.session();
  const DrawList& list = client.planned().list;
  double bound = 0;
  std::size_t relit = 0;
  std::vector<float> ages_ms;
  for (const DrawnImpostor& drawn : list.impostors) {
    relit += drawn.tile->relit ? 1 : 0;
    if (std::isfinite(drawn.bound_px)) bound = std::max(bound, drawn.bound_px);
    ages_ms.push_back(static_cast<float>(now_us - drawn.tile->received_us) / 1000.0f);
  }
  const FramePlan& plan = session.plan();
  const GpuBytes gpu = client.renderer().gpu_bytes();
  const TileCounts tiles = session.tiles();
  char text[1536];
  std::snprintf(
      text, sizeof(text),
      "{\"complete\":%s,\"atRest\":%s,\"refined\":%s,\"awaitsNewScene\":%s,\"references\":%s,"
      "\"geometry\":%s,"
      "\"budgetMs\":%g,\"plannedMs\":%g,\"mostMs\":%g,\"lambda\":%g,\"scale\":%g,\"samples\":%d,"
      "\"drawCalls\":%d,"
      "\"impostors\":%zu,\"relit\":%zu,\"meshes\":%zu,\"placeholders\":%zu,\"view\":%s,\"boundPx\":"
      "%g,\"expectedFlip\":%g,"
      "\"tauPx\":%g,\"overTau\":%zu,\"visible\":%zu,\"tileAgeS\":%g,\"bytesDown\":%llu,"
      "\"bytesUp\":%llu,\"roundTripMs\":%lld,\"inFlight\":%zu,\"tilesAsked\":%llu,"
      "\"tilesReceived\":%llu,"
      "\"codec\":\"%s\",\"gpuBytes\":%zu,\"targetBytes\":%zu,\"drawnFrames\":%llu,"
      "\"software\":%s}",
      session.scene().complete() ? "true" : "false", session.at_rest() ? "true" : "false",
      client.screen().refined() ? "true" : "false", session.awaits_new_scene() ? "true" : "false",
      session.scene().reference ? "true" : "false", session.scene().geometry ? "true" : "false",
      plan.limited() ? plan.budget_ms() : 0.0, plan.expected_ms(),
      plan.limited() ? plan.planned_ms() : 0.0, plan.lambda(), plan.setting().scale,
      plan.setting().samples, client.renderer().draw_calls(), list.impostors.size(), relit,
      list.meshes.size(), list.placeholders.size(), list.view ? "true" : "false", bound,
      plan.expected_flip(), session.tau_px(), list.over_tau, list.visible,
      static_cast<double>(quantile(ages_ms, 0.5)) / 1000,
      static_cast<unsigned long long>(traffic.bytes_down),
      static_cast<unsigned long long>(traffic.bytes_up),
      static_cast<long long>(session.round_trip_us() / 1000), session.in_flight(),
      static_cast<unsigned long long>(tiles.asked), static_cast<unsigned long long>(tiles.received),
      codec_name(session.codec()), gpu.all(), client.screen().gpu_bytes(),
      static_cast<unsigned long long>(drawn_frames), gl::is_software() ? "true" : "false");
  return text;
}

}  // namespace mirage
