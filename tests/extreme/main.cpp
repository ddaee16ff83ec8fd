// mirage-extreme: runs the stiff and extreme cases of numerics.md section 6, and prints for each
// one the input, what must hold, and what was measured.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "protocol/base/cli.h"
#include "protocol/base/resources.h"
#include "shaders/gl/health.h"
#include "tests/extreme/child_run.h"
#include "tests/extreme/registry.h"

namespace mirage::extreme {
namespace {

// Returns `corpus` beside the program, for one that was copied elsewhere, or the sources' own.
std::string corpus_folder() {
  std::error_code failed;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failed);
  const std::filesystem::path beside = self.parent_path() / "corpus";
  return std::filesystem::is_directory(beside, failed) ? beside.string()
                                                       : MIRAGE_SOURCE_DIR "/tests/fuzz/corpus";
}

struct Options {
  bool list = false, quick = false;
  int jobs = 1;
  std::vector<std::string> only;  ///< ids, or letters for all cases of that letter
  std::string json_file;
  std::string data = corpus_folder();
  std::string child, folder;  ///< the case to run for run_in_child(), and its folder
};

int parse(int argc, char** argv, Options& o) {
  CLI::App app("Runs the stiff and extreme cases.", "mirage-extreme");
  app.footer("The exit code is 0 if every case passed, 6 if one did not.");
  app.option_defaults()->group("Cases");
  app.add_flag("--list", o.list, "print id, input and what must hold of each case, and exit");
  app.add_option("--only", o.only, "run only these ids or letters, with commas: G5,V")
      ->type_name("NAMES")
      ->delimiter(',');
  app.add_flag("--quick", o.quick, "use a tenth of the random inputs and shorter scripts");
  app.add_option("--json", o.json_file, "write the rows to this file as JSON")->type_name("FILE");
  app.add_option("--data", o.data,
                 "folder of the fuzzers' corpus; default: corpus beside this program, else "
                 "tests/fuzz/corpus of the sources")
      ->type_name("DIR");
  app.add_option("--jobs", o.jobs,
                 "cases that run at the same time; those that measure time run alone")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--child", o.child)->group("");
  app.add_option("--folder", o.folder)->group("");
  add_conventions(app);
  return parse_command_line(app, argc, argv);
}

bool chosen(const Case& one, const std::vector<std::string>& only) {
  if (only.empty()) return true;
  for (const std::string& name : only) {
    if (name == one.id || (name.size() == 1 && name[0] == one.id[0])) return true;
  }
  return false;
}

nlohmann::json value(const Value& v) {
  if (const double* number = std::get_if<double>(&v)) return *number;
  return std::get<std::string>(v);
}

std::string text(const Value& v) {
  if (const double* number = std::get_if<double>(&v)) return number_text(*number);
  return std::get<std::string>(v);
}

int list(const std::vector<Case>& cases) {
  for (const Case& one : cases) {
    std::printf("%-4s %s -> %s\n", one.id, one.input, one.must_hold);
  }
  return static_cast<int>(ExitCode::kOk);
}

/// Scratch files of a run, removed at its end.
class Scratch {
 public:
  Scratch() {
    path_ = (std::filesystem::temp_directory_path() / "mirage-extreme-XXXXXX").string();
    if (!mkdtemp(path_.data())) path_ = ".";
  }
  ~Scratch() {
    std::error_code ignored;
    if (path_ != ".") std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

void tell(const Case& one, const ChildRun& r) {
  std::printf("%-4s %s %6.1f s %5ld MB  %s (%s)\n", one.id, r.outcome.pass ? "pass" : "FAIL",
              r.seconds, r.peak_mb, text(r.outcome.measured).c_str(),
              text(r.outcome.limit).c_str());
  std::fflush(stdout);
}

// Runs cases that need not be alone, `jobs` at a time, then the others one by one.
std::vector<ChildRun> run_all(const std::vector<Case>& cases, const Conditions& conditions,
                              int jobs) {
  std::vector<ChildRun> runs(cases.size());
  std::mutex told;
  for (const bool alone : {false, true}) {
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      for (std::size_t i = next++; i < cases.size(); i = next++) {
        if (cases[i].alone != alone) continue;
        runs[i] = run_in_child(cases[i], conditions);
        const std::lock_guard lock(told);
        tell(cases[i], runs[i]);
      }
    };
    std::vector<std::thread> workers;
    for (int k = 1; k < (alone ? 1 : jobs); ++k) workers.emplace_back(work);
    work();
    for (std::thread& worker : workers) worker.join();
  }
  return runs;
}

int run(const std::vector<Case>& cases, const Options& o) {
  const Scratch scratch;
  Conditions conditions;
  conditions.quick = o.quick;
  conditions.folder = scratch.path();
  conditions.data = o.data;
  nlohmann::json rows = nlohmann::json::array();
  int failed = 0;
  const std::vector<ChildRun> runs = run_all(cases, conditions, o.jobs);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& one = cases[i];
    const Outcome& outcome = runs[i].outcome;
    failed += outcome.pass ? 0 : 1;
    rows.push_back({{"id", one.id},
                    {"case", one.input},
                    {"must_hold", one.must_hold},
                    {"measured", value(outcome.measured)},
                    {"limit", value(outcome.limit)},
                    {"pass", outcome.pass}});
  }
  std::printf("%zu of %zu passed\n", cases.size() - static_cast<std::size_t>(failed), cases.size());
  if (!o.json_file.empty()) {
    std::ofstream file(o.json_file);
    const nlohmann::json whole = {{"rows", rows}};
    file << whole.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
    if (!file) return fail(make_error(ErrorId::kIo, "cannot write '" + o.json_file + "'"));
  }
  return static_cast<int>(failed == 0 ? ExitCode::kOk : ExitCode::kComparison);
}

int run_child(const std::vector<Case>& cases, const Options& o) {
  Conditions conditions;
  conditions.quick = o.quick;
  conditions.folder = o.folder;
  conditions.data = o.data;
  for (const Case& one : cases) {
    if (o.child == one.id) run_as_child(one, conditions);
  }
  return static_cast<int>(ExitCode::kOk);
}

int main_of(int argc, char** argv) {
  Options o;
  if (const int code = parse(argc, argv, o); code >= 0) return code;
  std::vector<Case> cases;
  const std::vector<Case> all = all_cases();
  if (!o.child.empty()) return run_child(all, o);
  if (const std::optional<std::string> id = misplaced_id(all)) {
    return fail(make_error(ErrorId::kInternal, "case " + *id + " is missing or there twice"));
  }
  std::copy_if(all.begin(), all.end(), std::back_inserter(cases),
               [&](const Case& one) { return chosen(one, o.only); });
  if (cases.empty()) return fail(make_error(ErrorId::kUsage, "no case has these ids"));
  if (o.list) return list(cases);
  const Result<void> enough = require_threads();
  return enough ? run(cases, o) : fail(enough.error());
}

}  // namespace
}  // namespace mirage::extreme

int main(int argc, char** argv) {
  return mirage::run_program(
      [&] { return mirage::gl::exit_without_leaks(mirage::extreme::main_of(argc, argv)); });
}
