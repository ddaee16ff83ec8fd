#include "tests/extreme/light_queue_case.h"

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/extreme/shapes.h"
#include "tests/support/process.h"

namespace mirage::extreme {
namespace {

using nlohmann::json;

constexpr int kBalls = 6;

json read_json(const std::string& path) {
  std::ifstream file(path);
  return json::parse(file, nullptr, false);
}

}  // namespace

Outcome light_every_frame(const Conditions& conditions) {
  Checks checks;
  const int fps = 30, frames = conditions.quick ? 90 : 300;
  test::Builder builder = document(dented_ball(12, 16));
  builder.doc["nodes"] = json::array();
  for (int i = 0; i < kBalls; ++i) {
    // Each is turned by its own angle, so the light differs in each one's space.
    builder.doc["nodes"].push_back({{"mesh", 0},
                                    {"translation", {3.0 * i, 0, 0.5 * i}},
                                    {"rotation", {0, std::sin(0.4 * i), 0, std::cos(0.4 * i)}}});
  }
  std::ofstream script(conditions.folder + "/light");
  for (int i = 0; i < frames; ++i) {
    const double angle = 0.05 * i;
    script << i * 1000.0 / fps << " 0.1 0.1 0.1 0.8 0.8 " << 0.5 + 0.001 * i << " "
           << std::cos(angle) << " -0.7 " << std::sin(angle) << "\n";
  }
  script.close();
  const test::Server server(write(builder, conditions.folder, "balls"));
  if (!server.ready()) {
    checks.failed("no server");
    return checks.outcome();
  }
  const std::string stats = conditions.folder + "/stats.json", trace = conditions.folder + "/trace";
  const test::Finished done = test::run({test::binary("mirage-view"),
                                         server.url(),
                                         "--offscreen",
                                         "160x90",
                                         "--virtual-time",
                                         "--frames",
                                         std::to_string(frames),
                                         "--fps",
                                         std::to_string(fps),
                                         "--path",
                                         "builtin:still",
                                         "--light",
                                         conditions.folder + "/light",
                                         "--relight",
                                         "never",
                                         "--mesh-radii",
                                         "0",
                                         "--method",
                                         "quad",
                                         "--msaa",
                                         "0",
                                         "--net",
                                         "rtt=50,rate=20",
                                         "--stats",
                                         stats,
                                         "--trace",
                                         trace},
                                        200);
  if (done.exit_code != 0) {
    checks.failed("client ended with " + std::to_string(done.exit_code));
    return checks.outcome();
  }
  const json numbers = read_json(stats), lives = read_json(trace).value("tiles", json::array());
  // Every tile is asked for and shown in the end; for which object.
  std::map<int, int> drawn_of;
  std::map<int, double> last_drawn, widest_gap;
  std::vector<std::pair<double, double>> under_way;
  for (const json& life : lives) {
    const int instance = life["instance"];
    under_way.emplace_back(life["asked_us"], life["received_us"]);
    if (life["first_drawn_us"].is_null() || life["first_drawn_us"] < 0) continue;
    const double at = life["first_drawn_us"];
    ++drawn_of[instance];
    if (last_drawn.count(instance)) {
      widest_gap[instance] = std::max(widest_gap[instance], at - last_drawn[instance]);
    }
    last_drawn[instance] = at;
  }
  std::size_t most = 0;
  for (const auto& [asked, received] : under_way) {
    std::size_t open = 0;
    for (const auto& other : under_way)
      open += other.first <= asked && asked < other.second ? 1 : 0;
    most = std::max(most, open);
  }
  double gap = 0;
  int fewest = 1 << 30;
  for (int i = 0; i < kBalls; ++i) {
    fewest = std::min(fewest, drawn_of.count(i) ? drawn_of[i] : 0);
    gap = std::max(gap, widest_gap[i] / 1000);
  }
  checks.at_most("most tiles under way", static_cast<double>(most), 4 * kBalls);
  checks.at_least("fewest new tiles shown by an object", fewest, frames / fps);
  checks.at_most("longest an object waited for newer light, ms", gap, 1000);
  checks.at_most("lag of the light shown, p95 ms",
                 numbers["light_lag_ms"]["p95"].is_number()
                     ? numbers["light_lag_ms"]["p95"].get<double>()
                     : 1e9,
                 500);
  return checks.outcome();
}

}  // namespace mirage::extreme
