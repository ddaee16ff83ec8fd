#include "client/report/options.h"

#include <map>

#include "protocol/base/cli.h"
#include "protocol/base/result.h"

namespace mirage {
namespace {

const std::map<std::string, std::set<ReportPart>>& parts() {
  static const std::map<std::string, std::set<ReportPart>> list = {
      {"fidelity", {ReportPart::kFidelity}},
      {"work-precision", {ReportPart::kWorkPrecision}},
      {"latency", {ReportPart::kLatency}},
      {"first", {ReportPart::kFirst}},
      {"bytes", {ReportPart::kBytes}},
      {"weather", {ReportPart::kWeather}},
      {"calibrate", {ReportPart::kCalibrate}},
      {"extreme", {ReportPart::kExtreme}},
      {"needs", {ReportPart::kNeeds}},
      {"models", {ReportPart::kModels}},
      {"all",
       {ReportPart::kFidelity, ReportPart::kWorkPrecision, ReportPart::kLatency, ReportPart::kFirst,
        ReportPart::kBytes, ReportPart::kWeather, ReportPart::kExtreme, ReportPart::kNeeds}}};
  return list;
}

std::set<std::string> names() {
  std::set<std::string> out;
  for (const auto& part : parts()) out.insert(part.first);
  return out;
}

Result<void> check(const ReportOptions& o) {
  if (!o.url.empty() && !o.scene.empty()) {
    return make_error(ErrorId::kUsage, "--url and --scene exclude each other",
                      "a running server has its own scene");
  }
  if (!o.model.empty() && o.what != "fidelity") {
    return make_error(ErrorId::kUsage, "--model is for fidelity only", "--scene FILE for the rest");
  }
  if (o.frame_ms > 0 && !parts().at(o.what).contains(ReportPart::kWeather)) {
    return make_error(ErrorId::kUsage, "--frame-ms is for weather only",
                      "work-precision has budgets of its own");
  }
  if ((o.what == "models") == o.models_dir.empty()) {
    return make_error(
        ErrorId::kUsage,
        o.models_dir.empty() ? "models needs a folder of glTF files" : "only models takes a folder",
        "mirage-report models DIR --out out/models");
  }
  if (o.what == "models" && !(o.url.empty() && o.scene.empty())) {
    return make_error(ErrorId::kUsage, "models starts a server for each file of its folder",
                      "leave out --url and --scene");
  }
  return {};
}

}  // namespace

int parse_options(int argc, char** argv, ReportOptions& o) {
  CLI::App app("Measures error against run time and writes a page about it.", "mirage-report");
  app.footer(
      "Writes DIR/index.html, to be opened in any browser, and CSV and JSON beside it.\n"
      "Example: mirage-report all --quick --out out/report");
  app.add_option(
         "WHAT", o.what,
         "fidelity: tiles against the mesh, by the field's protocol; work-precision: "
         "error against run time; latency: against video on the same link; first: the same "
         "from the moment of connecting; bytes: of walks, against all geometry and tiles only; "
         "calibrate: predicted error beside measured, and the coefficients that follow; "
         "weather: ten links, scenes and paths, several "
         "seeds (of them those on --scene); extreme: the extreme cases; needs: what was left "
         "out; all of these; models: each glTF file of a folder")
      ->required()
      ->check(CLI::IsMember(names()));
  app.add_option("DIR", o.models_dir, "with models: the folder, searched with all below it");
  app.add_option("--scene", o.scene,
                 "measure this file or builtin:NAME instead of the report's own scenes");
  app.add_option("--url", o.url, "measure the scene of a running server");
  app.add_option("--model", o.model, "fidelity of your own glTF file");
  app.add_option("--frame-ms", o.frame_ms,
                 "weather within this budget of a frame, ms, too, beside none; by the device model "
                 "'software'")
      ->check(number_within(0.0, 10'000.0));
  app.add_option("--out", o.out_dir, "folder to write into")->capture_default_str();
  app.add_flag("--quick", o.quick,
               "small pictures, small scenes, few frames: minutes instead of hours");
  app.add_option("--device", o.device, "EGL device")->capture_default_str();
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  if (const Result<void> good = check(o); !good) return fail(good.error());
  o.parts = parts().at(o.what);
  o.command_line = "mirage-report";
  for (int i = 1; i < argc; ++i) o.command_line += std::string(" ") + argv[i];
  return -1;
}

}  // namespace mirage
