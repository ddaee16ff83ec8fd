// mirage-view: link -> scene, tiles -> predictor -> selector -> scheduler -> link, and drawing with
// the true pose. viewer.cpp drives the stages frame by frame.

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "client/view/options.h"
#include "client/view/viewer.h"
#include "protocol/base/fail.h"
#include "protocol/base/resources.h"
#include "shaders/gl/health.h"

int main(int argc, char** argv) {
  return mirage::run_program([&] {
    mirage::ViewOptions options;
    if (const int code = mirage::parse_options(argc, argv, options); code >= 0) return code;
    spdlog::set_default_logger(spdlog::stderr_color_mt("mirage"));
    spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
    mirage::Result<void> done = mirage::require_addresses(mirage::kRendererMb);
    if (done) done = mirage::require_threads();
    if (done) done = mirage::run_viewer(options);
    return mirage::gl::exit_without_leaks(done.ok() ? 0 : mirage::fail(done.error()));
  });
}
