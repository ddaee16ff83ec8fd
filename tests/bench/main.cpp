// mirage-bench: prints one table of what things cost beside what they are compared with.

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "client/report/table.h"
#include "protocol/cli.h"
#include "tests/bench/bench.h"

namespace mirage::bench {
namespace {

struct Options {
  bool list = false, quick = false;
  std::vector<std::string> only;
  std::string json_file;
};

int main_of(int argc, char** argv) {
  Options o;
  CLI::App app{"Measures what Mirage costs beside floors and peers, in one run and in turn."};
  app.add_flag("--list", o.list, "names of the benchmarks");
  app.add_flag("--quick", o.quick, "fewer rounds, smaller scenes");
  app.add_option("--only", o.only, "names, with commas")->delimiter(',');
  app.add_option("--json", o.json_file, "write the rows here");
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  std::vector<Bench> benches;
  for (const auto& some : {selection_benches(), tile_benches(), store_benches()}) {
    benches.insert(benches.end(), some.begin(), some.end());
  }
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  int missed = 0;
  if (!o.list) {
    std::printf("%-52s %-22s %-34s %8s %7s  %s\n", "what", "ours", "beside", "ratio", "spread",
                "goal");
  }
  for (const Bench& bench : benches) {
    if (o.list) {
      std::printf("%-12s %s\n", bench.id, bench.what);
      continue;
    }
    if (!o.only.empty() && std::find(o.only.begin(), o.only.end(), bench.id) == o.only.end()) {
      continue;
    }
    const Result<std::vector<Row>> found = bench.run({o.quick});
    if (!found) return fail(found.error());
    const std::string command =
        fmt::format("mirage-bench{} --only {}", o.quick ? " --quick" : "", bench.id);
    for (const Row& r : *found) {
      missed += r.met ? 0 : 1;
      std::printf("%-52s %-22s %-34s %8.3g %5.0f %%  %s%s\n", r.what.c_str(), r.ours.c_str(),
                  r.beside.c_str(), r.ratio, r.spread_pct, r.goal.c_str(),
                  r.goal.empty() ? ""
                  : r.met        ? ": met"
                                 : ": MISSED");
      if (!r.note.empty()) std::printf("    %s\n", r.note.c_str());
      rows.push_back({{"what", r.what},
                      {"ours", r.ours},
                      {"beside", r.beside},
                      {"ratio", r.ratio},
                      {"spread_pct", r.spread_pct},
                      {"goal", r.goal},
                      {"met", r.met},
                      {"note", r.note},
                      {"command", command}});
    }
    std::printf("    %s\n", command.c_str());
    std::fflush(stdout);
  }
  if (!o.json_file.empty()) {
    const nlohmann::ordered_json whole = {{"rows", rows}};
    if (const Result<void> written = write_file(o.json_file, whole.dump(1) + "\n"); !written) {
      return fail(written.error());
    }
  }
  if (!o.list) std::printf("%d goals missed\n", missed);
  return 0;
}

}  // namespace
}  // namespace mirage::bench

int main(int argc, char** argv) { return mirage::bench::main_of(argc, argv); }
