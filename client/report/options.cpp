#include "client/report/options.h"

#include <map>

#include "protocol/base/cli.h"
#include "protocol/base/result.h"

namespace mirage {
namespace {

const std::map<std::string, std::set<ReportPart>>& parts() {
  static const std::map<std::string, std::set<ReportPart>> list = {
      {"real", {ReportPart::kReal}},
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
       {ReportPart::kReal, ReportPart::kFidelity, ReportPart::kWorkPrecision, ReportPart::kLatency,
        ReportPart::kFirst, ReportPart::kBytes, ReportPart::kWeather, ReportPart::kExtreme,
        ReportPart::kNeeds}}};
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
      "Parts:\n"
      "  real            frames by the clock of this machine, within several budgets\n"
      "  fidelity        tiles beside the mesh, by the field's protocol\n"
      "  work-precision  error against run time, for each way of drawing\n"
      "  latency         Mirage, video and geometry on the same modelled link\n"
      "  first           the same from the moment of connecting\n"
      "  bytes           bytes of walks, beside all geometry and beside tiles only\n"
      "  weather         ten links, scenes and paths, with several seeds\n"
      "  calibrate       predicted beside measured error, and the coefficients that follow\n"
      "  extreme         stiff and extreme cases\n"
      "  needs           what each scene was found not to need\n"
      "  models          each glTF file of a folder: drawn, true, difference\n\n"
      "DIR/index.html opens in any browser, offline; CSV and JSON lie beside it.\n\n"
      "Example: mirage-report all --quick --out out/report");
  app.option_defaults()->group("What is measured");
  app.add_option("WHAT", o.what,
                 "a part of the report, listed below; all: every part but calibrate and models")
      ->required()
      ->check(CLI::IsMember(names()));
  app.add_option("DIR", o.models_dir, "models: the folder of glTF files, searched recursively");
  app.add_option("--scene", o.scene,
                 "measure this file or builtin:NAME instead of the report's own scenes")
      ->type_name("SCENE");
  app.add_option("--url", o.url, "measure the scene of a running server")->type_name("URL");
  app.add_option("--model", o.model, "fidelity: measure this glTF file")->type_name("FILE");
  app.add_option("--frame-ms", o.frame_ms,
                 "weather: measure also within this frame budget, ms, by the device model "
                 "'software'")
      ->check(number_within(0.0, 10'000.0));
  app.option_defaults()->group("How");
  app.add_flag("--quick", o.quick,
               "small pictures, small scenes, few frames: minutes instead of hours");
  app.add_option("--out", o.out_dir, "folder to write into")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--device", o.device, "EGL device")->type_name("NAME")->capture_default_str();
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  if (const Result<void> good = check(o); !good) return fail(good.error());
  o.parts = parts().at(o.what);
  o.command_line = "mirage-report";
  for (int i = 1; i < argc; ++i) o.command_line += std::string(" ") + argv[i];
  return -1;
}

}  // namespace mirage
