// Selection benchmarks: the time in which a client decides, with selector and scheduler, by the
// number of instances.
#include <spdlog/fmt/fmt.h>

#include "server/prepare/prepared_scene.h"
#include "tests/bench/bench.h"
#include "tests/support/rig.h"

namespace mirage::bench {
namespace {

struct Walked {
  double frame_ms = 0, spread_pct = 0;
  std::size_t visible = 0, drawn = 0, without_image = 0;
};

// Walks into a field of this many instances, with empty pictures and an unlimited link. Takes the
// CPU time of deciding once the first seconds are over.
Result<Walked> walk_into(std::uint64_t instances, bool quick) {
  Result<std::shared_ptr<const PreparedScene>> scene =
      load_scene("builtin:field?instances=" + std::to_string(instances));
  if (!scene) return scene.error();
  test::RigOptions options;
  options.net.rtt_ms = 100;
  options.net.rate_mbps = 1000;
  options.net.server_ms = 0.01;
  options.frame_us = 16'667;
  test::Rig rig(*scene, options);
  rig.camera.width = 1280;
  rig.camera.height = 720;
  // Walks into the field, all of it ahead.
  const auto pose = [](double t) { return test::eye_at({0, 0, 3 - 1.4 * t}, {0, 0, -1000}); };
  rig.run(quick ? 6 : 15, pose);
  rig.deciding_ms.clear();
  const DrawList last = rig.run(quick ? 2 : 10, pose);
  const Middle ms = middle(rig.deciding_ms);
  return Walked{ms.median, ms.spread_pct, last.visible, last.impostors.size(),
                last.placeholders.size()};
}

Result<std::vector<Row>> deciding(const Conditions& conditions) {
  constexpr double kLimitMs = 1, kGrowth = 1.5;
  std::vector<Row> rows;
  double before_ms = 0;
  for (const std::uint64_t instances : {10'000ull, 100'000ull, 1'000'000ull}) {
    const Result<Walked> walked = walk_into(instances, conditions.quick);
    if (!walked) return walked.error();
    Row row;
    row.what = fmt::format("selector and scheduler, field of {} instances", instances);
    row.ours = fmt::format("{:.2f} ms a frame", walked->frame_ms);
    row.beside = before_ms > 0 ? fmt::format("a tenth of them: {:.2f} ms", before_ms)
                               : fmt::format("goal: {:g} ms", kLimitMs);
    row.ratio = walked->frame_ms / (before_ms > 0 ? before_ms : kLimitMs);
    row.goal = instances == 100'000 ? "<= 1 ms" : instances > 100'000 ? "<= 1.5 times" : "<= 1 ms";
    row.met = instances > 100'000 ? row.ratio <= kGrowth : walked->frame_ms <= kLimitMs;
    row.spread_pct = walked->spread_pct;
    row.note = fmt::format("{} in view, {} drawn from tiles, {} without an image", walked->visible,
                           walked->drawn, walked->without_image);
    rows.push_back(row);
    before_ms = walked->frame_ms;
  }
  return rows;
}

}  // namespace

std::vector<Bench> selection_benches() {
  return {{"selection", "selector and scheduler by the number of instances", deciding}};
}

}  // namespace mirage::bench
