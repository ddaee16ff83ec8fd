// Store benchmarks: what the tile store saves, as the server's CPU time for clients that ask what
// others asked before.
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/bench/bench.h"
#include "tests/support/process.h"

namespace mirage::bench {
namespace {

constexpr const char* kScene = "builtin:forest?trees=60";

// Returns the CPU time that a process has used so far with all threads, s.
double cpu_seconds(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

struct Loaded {
  double cpu_s = 0;
  double tiles = 0;
};

// Returns the server's CPU time for a run of scripted clients on the same path.
Result<Loaded> load(const test::Server& server, int clients, int seconds, int rate,
                    bool warm = false) {
  const std::string json = test::scratch_folder() + "/load.json";
  const double before = cpu_seconds(server.pid());
  std::vector<std::string> command = {test::binary("mirage-load"), server.url()};
  const auto add = [&](const char* name, int value) {
    command.insert(command.end(), {name, std::to_string(value)});
  };
  add("--clients", clients);
  add("--duration", seconds);
  add("--rate", rate);
  add("--spread", 0);
  command.insert(command.end(), {"--json", json});
  if (warm) command.emplace_back("--warm");
  const test::Finished run = test::run(command, 300);
  if (run.exit_code != 0) return make_error(ErrorId::kInternal, "mirage-load: " + run.output);
  std::ifstream file(json);
  const auto found = nlohmann::json::parse(file, nullptr, false);
  if (found.is_discarded()) return make_error(ErrorId::kInternal, "mirage-load wrote no JSON");
  return Loaded{cpu_seconds(server.pid()) - before, found["tiles"].get<double>()};
}

Result<std::vector<Row>> store(const Conditions& conditions) {
  const test::Server server(kScene);
  if (!server.ready()) return make_error(ErrorId::kInternal, "no server: " + server.log());
  const int seconds = conditions.quick ? 5 : 20;
  std::vector<Row> rows;
  const Result<Loaded> first = load(server, 1, seconds, 40);
  if (!first) return first.error();
  std::vector<double> later;
  for (int i = 0; i < (conditions.quick ? 3 : 8); ++i) {
    const Result<Loaded> again = load(server, 1, seconds, 40);
    if (!again) return again.error();
    later.push_back(again->cpu_s);
  }
  const Middle nth = middle(later);
  const double share = nth.median / first->cpu_s;
  rows.push_back({"server, a later client on the same path",
                  fmt::format("{:.2f} CPU s", nth.median),
                  fmt::format("the first client: {:.2f} CPU s", first->cpu_s), share, "<= 0.2",
                  share <= 0.2, nth.spread_pct, fmt::format("{:.0f} tiles each", first->tiles)});
  if (const Result<Loaded> warm = load(server, 64, seconds, 20, true); !warm) return warm.error();
  const Result<Loaded> many = load(server, 64, seconds, 20);
  if (!many) return many.error();
  const double us = 1e6 * many->cpu_s / many->tiles;
  rows.push_back({"server, 64 clients on a warm store, a tile", fmt::format("{:.0f} CPU us", us),
                  "goal: 100 us beyond the socket", us / 100, "<= 1", us <= 100, std::nullopt,
                  fmt::format("{:.0f} tiles, everything counted, the socket too", many->tiles)});
  return rows;
}

}  // namespace

std::vector<Bench> store_benches() {
  return {{"store", "tiles that were made for others before", store}};
}

}  // namespace mirage::bench
