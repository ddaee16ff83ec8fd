#include "client/report/bytes_rows.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "client/plan/selector_rules.h"

namespace mirage {
namespace {

constexpr const char *kGeometry = "geometry", *kTiles = "tiles";
// A picture is as good with so much more FLIP.
constexpr double kAsGood = 0.01;
constexpr int kComparedFrames = 5;  // of a walk, at least

bool is_mirage(const BytesRun& run) { return run.delivery != kGeometry && run.delivery != kTiles; }

bool same_walk(const BytesRun& a, const BytesRun& b) {
  return a.scene == b.scene && a.walk_s == b.walk_s;
}

bool as_good(const BytesRun& run, const BytesRun& mirage) {
  return run.flip_mean <= mirage.flip_mean + kAsGood;
}

}  // namespace

BytesPlan bytes_plan(bool quick) {
  BytesPlan plan;
  plan.deliveries = {{"auto", "auto", kSwapRadii, 0},
                     {"auto within 50 ms", "auto", kSwapRadii, 50},
                     {kGeometry, "mesh", kSwapRadii, 0},
                     {kTiles, "auto", 0, 0}};
  plan.fps = 10;
  plan.net.rtt_ms = 100;
  plan.net.rate_mbps = 20;
  plan.net.server_ms = 5;
  if (quick) {
    plan.scenes = {"builtin:forest?trees=60", "builtin:clutter?objects=150",
                   "builtin:museum?objects=12&triangles=60000"};
    plan.walks_s = {5, 10};
    plan.width = 240;
    plan.height = 135;
  } else {
    plan.scenes = {"builtin:forest", "builtin:clutter", "builtin:city",
                   "builtin:museum?objects=60"};
    plan.walks_s = {10, 60};
    plan.width = 640;
    plan.height = 360;
  }
  return plan;
}

std::vector<int> compared_seconds(int walk_s) {
  const int step = std::max(1, walk_s / kComparedFrames);
  std::vector<int> out;
  for (int s = step; s <= walk_s; s += step) out.push_back(s);
  return out;
}

std::vector<BytesBeside> bytes_beside(const std::vector<BytesRun>& runs) {
  std::vector<BytesBeside> out;
  for (const BytesRun& mirage : runs) {
    if (!is_mirage(mirage)) continue;
    BytesBeside one{&mirage, nullptr};
    for (const BytesRun& other : runs) {
      if (is_mirage(other) || !same_walk(other, mirage) || !as_good(other, mirage)) continue;
      if (!one.better || other.mb < one.better->mb) one.better = &other;
    }
    out.push_back(one);
  }
  return out;
}

Table bytes_table(const std::vector<BytesRun>& runs) {
  Table table({"scene", "walk_s", "delivery", "mb_down", "flip_mean", "flip_after_5s",
               "first_picture_ms", "client_ms_p50", "client_ms_p95", "better", "over_better"});
  const std::vector<BytesBeside> compared = bytes_beside(runs);
  for (const BytesRun& run : runs) {
    const auto of_run = std::find_if(compared.begin(), compared.end(),
                                     [&](const BytesBeside& c) { return c.mirage == &run; });
    const BytesRun* better = of_run == compared.end() ? nullptr : of_run->better;
    table.add({run.scene, std::to_string(run.walk_s), run.delivery, figure(run.mb),
               figure(run.flip_mean), figure(run.flip_after_5s), figure(run.first_picture_ms),
               figure(run.client_ms_p50), figure(run.client_ms_p95),
               better ? better->delivery : "n/a", figure(better ? run.mb / better->mb : NAN)});
  }
  return table;
}

std::vector<std::string> bytes_words(const std::vector<BytesRun>& runs) {
  std::vector<std::string> out;
  for (const auto& [mirage, better] : bytes_beside(runs)) {
    std::string line = fmt::format("{}, {} s, {}: {:.2f} MB, FLIP {:.3f}; ", mirage->scene,
                                   mirage->walk_s, mirage->delivery, mirage->mb, mirage->flip_mean);
    line += better ? fmt::format("{:.2f} times the bytes of {} with FLIP {:.3f}",
                                 mirage->mb / better->mb, better->delivery, better->flip_mean)
                   : "neither all geometry nor tiles only shows as good a picture";
    out.push_back(line);
  }
  return out;
}

}  // namespace mirage
