// mirage-load: options -> run (meet, plan, warm, connect, ask, wait; load_run.h) -> report.

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <fstream>

#include "client/load/load_run.h"
#include "client/load/options.h"
#include "client/load/report.h"
#include "protocol/base/fail.h"
#include "protocol/base/resources.h"

namespace mirage {
namespace {

Result<void> write_report(const LoadResults& results, const std::string& json_file) {
  if (!json_file.empty()) {
    std::ofstream file(json_file);
    file << to_json(results) << std::flush;
    if (!file) return make_error(ErrorId::kIo, "cannot write '" + json_file + "'");
  }
  std::fputs(to_table(results).c_str(), stdout);
  std::fflush(stdout);
  return {};
}

Result<void> run_load(const LoadOptions& options) {
  // Checks now, not after the run, that the file can be written; nothing is written yet.
  if (!options.json_file.empty() && !std::ofstream(options.json_file, std::ios::app)) {
    return make_error(ErrorId::kIo, "cannot write '" + options.json_file + "'");
  }
  Result<LoadResults> results = LoadRun(options).run();
  if (!results) return results.error();
  if (Result<void> written = write_report(*results, options.json_file); !written) return written;
  if (results->verify_failures > 0) {
    return make_error(ErrorId::kComparison,
                      std::to_string(results->verify_failures) +
                          " tiles failed verification; the first: " + results->first_failure);
  }
  if (results->connected_at_end == 0) {
    return make_error(ErrorId::kNetworkClosed, "the server went away during the run");
  }
  return {};
}

}  // namespace
}  // namespace mirage

int main(int argc, char** argv) {
  return mirage::run_program([&] {
    mirage::LoadOptions options;
    if (const int code = mirage::parse_options(argc, argv, options); code >= 0) return code;
    spdlog::set_default_logger(spdlog::stderr_color_mt("mirage"));
    spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
    mirage::Result<void> done = mirage::require_threads();
    if (done) done = mirage::run_load(options);
    return done.ok() ? 0 : mirage::fail(done.error());
  });
}
