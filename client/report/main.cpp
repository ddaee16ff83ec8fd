// mirage-report: options -> parts -> page -> exit code. Each part measures, and writes its file and
// its section of the page.

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <filesystem>

#include "client/report/bytes.h"
#include "client/report/calibrate.h"
#include "client/report/context.h"
#include "client/report/fidelity.h"
#include "client/report/first.h"
#include "client/report/latency.h"
#include "client/report/models.h"
#include "client/report/outside.h"
#include "client/report/real.h"
#include "client/report/session_run.h"
#include "client/report/weather.h"
#include "client/report/work_precision.h"
#include "protocol/base/fail.h"
#include "protocol/base/resources.h"
#include "shaders/gl/health.h"

namespace mirage {
namespace {

Result<void> measure(Context& context) {
  using Step = std::pair<ReportPart, Result<void> (*)(Context&)>;
  const auto wanted = [&](ReportPart part) { return context.options.parts.contains(part); };
  const auto take = [&](const std::vector<Step>& steps) -> Result<void> {
    for (const auto& [part, step] : steps) {
      if (!wanted(part)) continue;
      if (Result<void> done = step(context); !done) return done;
    }
    return {};
  };
  // These parts measure times, so nothing runs beside them.
  const std::vector<Step> alone = {{ReportPart::kReal, report_real},
                                   {ReportPart::kWorkPrecision, report_work_precision}};
  if (Result<void> done = take(alone); !done) return done;
  ExtremeRun extreme;
  if (wanted(ReportPart::kExtreme)) extreme = start_extreme(context);
  const std::vector<Step> beside = {
      {ReportPart::kLatency, report_latency},   {ReportPart::kFirst, report_first},
      {ReportPart::kBytes, report_bytes},       {ReportPart::kWeather, report_weather},
      {ReportPart::kFidelity, report_fidelity}, {ReportPart::kNeeds, report_needs},
      {ReportPart::kModels, report_models},     {ReportPart::kCalibrate, report_calibrate}};
  if (Result<void> done = take(beside); !done) return done;
  if (!wanted(ReportPart::kExtreme)) return {};
  return report_extreme(context, std::move(extreme));
}

Result<void> write_page(Context& context) {
  Page& page = context.page;
  page.section("omissions", "What was not measured");
  if (context.omissions.empty()) page.paragraph("Everything that was asked for was measured.");
  Table table({"part", "what", "why"});
  for (const Omission& omission : context.omissions) {
    table.add({omission.part, omission.what, omission.why});
  }
  if (!context.omissions.empty()) page.table(table);
  std::vector<std::string> origin = {"Written by: " + context.options.command_line + " (commit " +
                                     source_commit() + ")."};
  if (context.runner) {
    origin.push_back("Renderer of the client: " + context.runner->renderer_name() + ".");
  }
  return write_file(context.path("index.html"),
                    page.html("Mirage: measured", context.failed_checks, origin));
}

Result<void> run_report(const ReportOptions& options) {
  std::error_code failed;
  std::filesystem::create_directories(options.out_dir + "/plots", failed);
  if (failed) return make_error(ErrorId::kIo, "cannot make directory '" + options.out_dir + "'");
  Context context{options, Plotter(options.out_dir + "/plots")};
  if (!context.plotter.available()) {
    spdlog::warn("gnuplot is not installed: figures without plots (apt-get install gnuplot-nox)");
  }
  if (Result<void> measured = measure(context); !measured) return measured;
  if (Result<void> written = write_page(context); !written) return written;
  std::printf("%s: %.0f s, %zu omissions\n", context.path("index.html").c_str(),
              context.progress.elapsed_s(), context.omissions.size());
  if (context.failed_checks.empty()) return {};
  return make_error(ErrorId::kComparison, context.failed_checks.front());
}

}  // namespace
}  // namespace mirage

int main(int argc, char** argv) {
  return mirage::run_program([&] {
    mirage::ReportOptions options;
    if (const int code = mirage::parse_options(argc, argv, options); code >= 0) return code;
    spdlog::set_default_logger(spdlog::stderr_color_mt("mirage"));
    spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
    mirage::Result<void> done = mirage::require_threads();
    if (done) done = mirage::run_report(options);
    return mirage::gl::exit_without_leaks(done.ok() ? 0 : mirage::fail(done.error()));
  });
}
