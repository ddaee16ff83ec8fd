// mirage-bench: prints one table with what things cost, and what they are compared with.

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "client/report/table.h"
#include "protocol/base/cli.h"
#include "protocol/base/resources.h"
#include "shaders/gl/health.h"
#include "tests/bench/bench.h"

namespace mirage::bench {
namespace {

constexpr int kSkipped = 77;  // exit code for "skipped" in test drivers

struct Options {
  bool list = false, quick = false, software = false;
  std::vector<std::string> only;
  std::string json_file;
  std::string device = "auto";
};

void print(const Row& r) {
  const std::string spread = r.spread_pct ? fmt::format("{:.1f} %", *r.spread_pct) : "n/a";
  const char* verdict = r.goal.empty() ? "" : r.met ? ": met" : ": MISSED";
  std::printf("%-52s %-22s %-34s %8.3g %7s  %s%s\n", r.what.c_str(), r.ours.c_str(),
              r.beside.c_str(), r.ratio, spread.c_str(), r.goal.c_str(), verdict);
  if (!r.note.empty()) std::printf("    %s\n", r.note.c_str());
}

nlohmann::ordered_json json_of(const Row& r, const std::string& command) {
  nlohmann::ordered_json row = {{"what", r.what},   {"ours", r.ours},    {"beside", r.beside},
                                {"ratio", r.ratio}, {"goal", r.goal},    {"met", r.met},
                                {"note", r.note},   {"command", command}};
  if (r.spread_pct) row["spread_pct"] = *r.spread_pct;
  return row;
}

// Returns the benchmarks with these names, or all. Error kUsage for an unknown name.
Result<std::vector<Bench>> chosen(const std::vector<std::string>& names) {
  std::vector<Bench> all, out;
  for (const auto& some :
       {selection_benches(), tile_benches(), store_benches(), startup_benches(), latency_benches(),
        codec_benches(), client_benches(), price_benches(), gpu_benches()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  if (names.empty()) return all;
  for (const std::string& name : names) {
    const auto at =
        std::find_if(all.begin(), all.end(), [&](const Bench& bench) { return bench.id == name; });
    if (at == all.end()) {
      return make_error(ErrorId::kUsage, "no benchmark '" + name + "' (hint: --list names them)");
    }
    out.push_back(*at);
  }
  return out;
}

int main_of(int argc, char** argv) {
  Options o;
  CLI::App app("Measures what Mirage costs beside floors and peers, in one run and in turn.",
               "mirage-bench");
  app.footer(
      "The exit code is 0 also when a goal is missed: the table says so. It is 77 when there is no "
      "device for any of the benchmarks.");
  app.option_defaults()->group("Benchmarks");
  app.add_flag("--list", o.list, "print the names of the benchmarks and exit");
  app.add_flag("--quick", o.quick, "fewer rounds, smaller scenes");
  app.add_option("--only", o.only, "run only these, names with commas between")
      ->type_name("NAMES")
      ->delimiter(',');
  app.add_option("--json", o.json_file, "write the rows to this file as JSON")->type_name("FILE");
  app.add_option("--device", o.device,
                 "EGL device of the benchmark gpu: auto, surfaceless, device0, …")
      ->type_name("NAME")
      ->capture_default_str();
  app.add_flag("--software", o.software, "run the benchmark gpu on a software renderer, too");
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  const Result<std::vector<Bench>> benches = chosen(o.only);
  if (!benches) return fail(benches.error());
  if (o.list) {
    for (const Bench& bench : *benches) std::printf("%-12s %s\n", bench.id, bench.what);
    return 0;
  }
  if (const Result<void> enough = require_threads(); !enough) return fail(enough.error());
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  int missed = 0;
  std::size_t skipped = 0;
  std::printf("%-52s %-22s %-34s %8s %7s  %s\n", "what", "ours", "beside", "ratio", "spread",
              "goal");
  for (const Bench& bench : *benches) {
    if (bench.hardware && !o.software) {
      const Result<bool> hardware = is_hardware(o.device);
      if (!hardware) return fail(hardware.error());
      if (!*hardware) {
        std::printf("%s: skipped, '%s' is no graphics card (--software: run it all the same)\n",
                    bench.id, o.device.c_str());
        ++skipped;
        continue;
      }
    }
    std::fprintf(stderr, "%s: %s …\n", bench.id, bench.what);
    const Result<std::vector<Row>> found = bench.run({o.quick, o.device});
    if (!found) return fail(found.error());
    const std::string command =
        fmt::format("mirage-bench{} --only {}", o.quick ? " --quick" : "", bench.id);
    for (const Row& row : *found) {
      missed += row.met ? 0 : 1;
      print(row);
      rows.push_back(json_of(row, command));
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
  std::printf("%d goals missed\n", missed);
  return skipped == benches->size() ? kSkipped : 0;
}

}  // namespace
}  // namespace mirage::bench

int main(int argc, char** argv) {
  return mirage::run_program(
      [&] { return mirage::gl::exit_without_leaks(mirage::bench::main_of(argc, argv)); });
}
