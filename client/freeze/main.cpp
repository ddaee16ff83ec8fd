// mirage-freeze: options -> run (server, parts, finish; freeze_run.h).

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "client/freeze/freeze_run.h"
#include "client/freeze/options.h"
#include "protocol/base/fail.h"
#include "protocol/base/resources.h"

int main(int argc, char** argv) {
  return mirage::run_program([&] {
    mirage::FreezeOptions options;
    if (const int code = mirage::parse_options(argc, argv, options); code >= 0) return code;
    spdlog::set_default_logger(spdlog::stderr_color_mt("mirage"));
    spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
    mirage::Result<void> done = mirage::require_threads();
    if (done) done = mirage::FreezeRun(options).run();
    return done.ok() ? 0 : mirage::fail(done.error());
  });
}
