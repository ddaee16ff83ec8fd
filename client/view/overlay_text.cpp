#include "client/view/overlay_text.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "client/frame/draw_list.h"
#include "client/hold/tile_cache.h"
#include "client/host/client_host.h"
#include "client/link/link.h"
#include "client/plan/frame_plan.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "protocol/base/quantile.h"

namespace mirage {

std::string overlay_text(const ClientHost& host, const DrawList& list,
                         const OverlayFigures& figures, std::int64_t now_us) {
  const ClientSession& session = host.session();
  double bound = 0;
  std::vector<float> ages_ms;
  for (const DrawnImpostor& drawn : list.impostors) {
    if (std::isfinite(drawn.bound_px)) bound = std::max(bound, drawn.bound_px);
    ages_ms.push_back(static_cast<float>(now_us - drawn.tile->received_us) / 1000.0f);
  }
  const LinkTraffic traffic = host.traffic();
  const FramePlan& plan = session.plan();
  const std::string budget = plan.limited()
                                 ? fmt::format("{:.0f} of {:.0f} ms planned, lambda {:.0f}, ",
                                               plan.expected_ms(), plan.budget_ms(), plan.lambda())
                                 : "no budget, ";
  return fmt::format(
      "{:.0f} fps, {} draw calls\n{}scale {:g}, {} samples\n{} impostors, {} meshes, {} without "
      "image\nbound {:.1f} px "
      "worst, expected FLIP {:.3f}, "
      "{} of {} over tau\ntile age {:.1f} s median\n{:.2f} MB down, round trip {} ms{}{}",
      1000.0 / std::max(figures.frame_ms, 0.1), figures.draw_calls, budget, plan.setting().scale,
      plan.setting().samples, list.impostors.size(), list.meshes.size(), list.placeholders.size(),
      bound, plan.expected_flip(), list.over_tau, list.visible, quantile(ages_ms, 0.5) / 1000.0f,
      static_cast<double>(traffic.bytes_down) * 1e-6, session.round_trip_us() / 1000,
      session.scene().geometry ? "" : "\nthe server keeps its geometry: images only",
      host.link_up() ? "" : "\nOFFLINE: showing what is here, reconnecting");
}

}  // namespace mirage
