#include "client/report/first_rows.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

NetModel link(double rtt_ms, double rate_mbps) {
  NetModel net;
  net.rtt_ms = rtt_ms;
  net.rate_mbps = rate_mbps;
  net.server_ms = 5;
  return net;
}

}  // namespace

FirstPlan first_plan(bool quick) {
  FirstPlan plan;
  plan.scenes = {quick ? "builtin:forest?trees=60" : "builtin:forest"};
  plan.methods = {"mirage", "video+timewarp", "geometry"};
  plan.links = {link(20, 100), link(100, 20), link(400, 2)};
  plan.width = quick ? 240 : 480;
  plan.height = quick ? 135 : 270;
  plan.fps = quick ? 30 : 60;
  plan.compare_every = quick ? 3 : 6;
  return plan;
}

FirstFigures first_figures(const LatencyRun& run) {
  FirstFigures out{NAN, NAN, NAN};
  if (run.first_image_ms < 0) return out;
  out.picture_ms = run.first_image_ms;
  constexpr double kRounding = 1e-9;
  const double from = 1e-3 * run.first_image_ms - kRounding, to = from + 1 + kRounding;
  double sum = 0, n = 0;
  for (const LatencySample& s : run.samples) {
    if (s.seconds < from || s.seconds > to) continue;
    if (n == 0) out.flip = s.flip;
    sum += s.flip;
    n += 1;
  }
  if (n > 0 && run.samples.back().seconds >= to) out.second_after = sum / n;
  return out;
}

Table first_table(const std::vector<LatencyRun>& runs) {
  Table table({"scene", "path", "rtt_ms", "rate_mbps", "method", "first_picture_ms",
               "first_picture_flip", "second_after_flip"});
  for (const LatencyRun& run : runs) {
    const FirstFigures f = first_figures(run);
    const NetModel& net = run.condition.net;
    table.add({run.scene, run.condition.path, figure(net.rtt_ms), figure(net.rate_mbps), run.method,
               figure(f.picture_ms), figure(f.flip), figure(f.second_after)});
  }
  return table;
}

Table first_frames(const std::vector<LatencyRun>& runs) {
  Table table({"scene", "path", "rtt_ms", "rate_mbps", "method", "seconds", "flip"});
  for (const LatencyRun& run : runs) {
    const NetModel& net = run.condition.net;
    for (const LatencySample& s : run.samples) {
      table.add({run.scene, run.condition.path, figure(net.rtt_ms), figure(net.rate_mbps),
                 run.method, figure(s.seconds), figure(s.flip)});
    }
  }
  return table;
}

std::vector<Panel> first_panels(const std::vector<LatencyRun>& runs) {
  std::vector<Panel> panels;
  for (const LatencyRun& run : runs) {
    const NetModel& net = run.condition.net;
    const std::string title =
        fmt::format("{}, RTT {:g} ms, {:g} Mbit/s", run.scene, net.rtt_ms, net.rate_mbps);
    const auto same = [&](const Panel& panel) { return panel.title == title; };
    auto panel = std::find_if(panels.begin(), panels.end(), same);
    if (panel == panels.end()) {
      panels.push_back({title, "seconds since connecting began", "FLIP", false, false, {}, {}, {}});
      panel = panels.end() - 1;
    }
    Series series{run.method, {}};
    for (const LatencySample& s : run.samples) series.points.emplace_back(s.seconds, s.flip);
    panel->series.push_back(std::move(series));
  }
  return panels;
}

}  // namespace mirage
