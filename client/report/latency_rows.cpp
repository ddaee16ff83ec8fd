#include "client/report/latency_rows.h"

#include <cmath>

#include "protocol/base/quantile.h"

namespace mirage {
namespace {

NetModel link(double rtt, double jitter, double rate, double loss, std::uint64_t seed) {
  NetModel net;
  net.rtt_ms = rtt;
  net.jitter_ms = jitter;
  net.rate_mbps = rate;
  net.loss_percent = loss;
  net.server_ms = 5;
  net.seed = seed;
  return net;
}

}  // namespace

LatencyPlan latency_plan(bool quick) {
  LatencyPlan plan;
  plan.methods = {"video", "video+timewarp", "geometry", "mirage"};
  const std::string own;
  if (quick) {
    plan.scenes = {"builtin:clutter?objects=150"};
    plan.width = 240;
    plan.height = 135;
    for (const double rtt : {0, 50, 100, 200, 400}) {
      for (const double rate : {2, 5, 20}) {  // 50 would be no limit for a picture this small
        plan.conditions.push_back({own, link(rtt, 0, rate, 0, 1)});
      }
    }
    return plan;
  }
  plan.methods.insert(plan.methods.begin() + 2, "fixed8");
  plan.scenes = {"builtin:forest", "builtin:clutter", "builtin:museum"};
  plan.width = 640;
  plan.height = 360;
  plan.seconds = 10;
  plan.compare_every = 10;
  // Round trips with their jitter, as published measurements have them.
  const std::pair<double, double> trips[] = {{0, 0},    {20, 2},   {50, 10},
                                             {100, 20}, {200, 40}, {400, 100}};
  for (const auto& [rtt, jitter] : trips) {
    for (const double rate : {2, 5, 10, 20, 50, 100}) {
      plan.conditions.push_back({own, link(rtt, jitter, rate, 0, 1)});
    }
    for (const std::uint64_t seed : {2, 3}) {
      plan.conditions.push_back({own, link(rtt, jitter, 20, 0, seed)});
    }
  }
  for (const double loss : {0.1, 1.0}) {
    plan.conditions.push_back({own, link(100, 20, 20, loss, 1)});
  }
  for (const char* path : {"still", "orbit", "fly", "shake", "strafe", "teleport"}) {
    plan.conditions.push_back({std::string("builtin:") + path, link(100, 20, 20, 0, 1)});
  }
  return plan;
}

LatencyFigures figures_of(const LatencyRun& run, double from_seconds) {
  std::vector<double> flip, pose;
  double flips = 0, holes = 0;
  for (const LatencySample& s : run.samples) {
    if (s.seconds < from_seconds) continue;
    flip.push_back(s.flip);
    pose.push_back(s.pose_to_display_ms);
    flips += s.flip;
    holes += s.hole_fraction;
  }
  if (flip.empty()) return {NAN, NAN, NAN, NAN, run.mbps};
  const auto n = static_cast<double>(flip.size());
  return {flips / n, quantile(flip, 0.95), quantile(pose, 0.99), holes / n, run.mbps};
}

Table latency_table(const std::vector<LatencyRun>& runs, double from_seconds) {
  Table table({"scene", "path", "method", "rtt_ms", "rate_mbps", "loss_pct", "seed", "flip_mean",
               "flip_p95", "mbps", "pose_to_display_ms_p99", "hole_fraction", "first_image_ms"});
  for (const LatencyRun& run : runs) {
    const LatencyFigures f = figures_of(run, from_seconds);
    const NetModel& net = run.condition.net;
    table.add({run.scene, run.condition.path, run.method, figure(net.rtt_ms), figure(net.rate_mbps),
               figure(net.loss_percent), std::to_string(net.seed), figure(f.flip_mean),
               figure(f.flip_p95), figure(run.mbps), figure(f.pose_to_display_ms_p99),
               figure(f.hole_fraction),
               run.first_image_ms < 0 ? "n/a" : figure(run.first_image_ms)});
  }
  return table;
}

}  // namespace mirage
