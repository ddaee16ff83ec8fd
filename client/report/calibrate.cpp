#include "client/report/calibrate.h"

#include <spdlog/fmt/fmt.h>

#include <cstdio>

#include "client/report/calibrate_rows.h"

namespace mirage {
namespace {

constexpr const char* kCalibratePart = "calibrate";
constexpr int kCalibrateWidth = 480, kCalibrateHeight = 270;
constexpr double kCalibrateFps = 10;

// A manner of drawing. The manners are chosen so that every way to draw a thing occurs.
struct Manner {
  double frame_ms = 0;
  int samples = -1;
  double tau_px = 1;
  double mesh_radii = kAnyRadii;
};
const Manner kManners[] = {{15},   {30},         {60},         {150},        {0, 1},
                           {0, 4}, {0, 1, 1, 0}, {0, 1, 4, 0}, {0, 4, 1, 0}, {0, 4, 0.5, 3}};

struct Scenes {
  std::vector<std::string> fitted, held_out;
  int frames;
};

Scenes scenes(bool quick) {
  if (quick) {
    return {
        {"builtin:forest?trees=60", "builtin:clutter?objects=150"}, {"builtin:city?blocks=3"}, 41};
  }
  return {{"builtin:forest", "builtin:clutter"},
          {"builtin:city", "builtin:museum?objects=12&triangles=60000", "builtin:forest?seed=2"},
          101};
}

RunSpec spec_of(const OpenScene& scene, const Manner& manner, int frames) {
  RunSpec spec;
  spec.url = scene.url;
  spec.path = scene.path();
  spec.tau_px = manner.tau_px;
  spec.mesh_radii = manner.mesh_radii;
  spec.frame_ms = manner.frame_ms;
  spec.samples = manner.samples;
  spec.device = device_model("software");
  spec.net.rtt_ms = 100;
  spec.net.rate_mbps = 20;
  spec.net.server_ms = 5;
  spec.width = kCalibrateWidth;
  spec.height = kCalibrateHeight;
  spec.fps = kCalibrateFps;
  spec.frames = frames;
  spec.from_scene = true;
  // The first moments are compared as well, for views and for things that are not there yet.
  for (const int frame : {2, 5, 15}) spec.compared.push_back(frame);
  for (int frame = 30; frame < frames; frame += 10) spec.compared.push_back(frame);
  return spec;
}

Result<std::vector<ErrorSample>> observe(Context& context, const std::vector<std::string>& names,
                                         int frames) {
  std::vector<ErrorSample> out;
  for (const std::string& name : names) {
    const Result<OpenScene*> scene = context.open(name);
    if (!scene) {
      context.omit(kCalibratePart, name, scene.error().line());
      continue;
    }
    for (const Manner& manner : kManners) {
      context.progress.step(fmt::format("{}, {:g} ms, {} samples, tau {:g}", name, manner.frame_ms,
                                        manner.samples, manner.tau_px));
      RunSpec spec = spec_of(**scene, manner, frames);
      spec.observe = [&](const ObservedFrame& frame) {
        for (ErrorSample& sample : samples_of(frame, name)) out.push_back(std::move(sample));
      };
      const Result<RunResult> run = context.runner->run(spec, *(*scene)->truth);
      if (!run) return run.error();
    }
    context.close(name);
  }
  return out;
}

// Adds rows for each way of drawing and for all of them, by the model in use and by the new one.
void judge(Table& table, const std::string& what, const std::vector<ErrorSample>& samples,
           const ErrorModel& fitted) {
  const auto row = [&](const std::string& look, const std::vector<ErrorSample>& part) {
    std::vector<std::string> cells = {what, look, fmt::format("{}", part.size())};
    for (const ErrorModel* model : {&error_model(), &fitted}) {
      const RankCorrelation rank = rank_correlation(part, *model);
      cells.push_back(fmt::format("{:.2f}", rank.error));
      cells.push_back(fmt::format("{:.2f}", rank.flip));
      cells.push_back(fmt::format("{:+.4f}", mean_excess(part, *model)));
    }
    table.add(cells);
  };
  for (const Look look : {Look::kNothing, Look::kView, Look::kFlat, Look::kDeep, Look::kMesh}) {
    std::vector<ErrorSample> part;
    for (const ErrorSample& sample : samples) {
      if (sample.look == look) part.push_back(sample);
    }
    if (!part.empty()) row(look_name(look), part);
  }
  row("all", samples);
}

Panel predicted_beside_measured(const std::vector<ErrorSample>& samples) {
  Panel panel{"error of an object", "predicted FLIP", "measured FLIP", true, true, {}, {}, {}};
  for (const Look look : {Look::kView, Look::kFlat, Look::kDeep, Look::kMesh}) {
    Series series{look_name(look), {}};
    for (const ErrorSample& sample : samples) {
      if (sample.look != look) continue;
      series.points.emplace_back(error_model().flip_of(sample.wrongs), sample.flip);
    }
    if (!series.points.empty()) panel.series.push_back(std::move(series));
  }
  return panel;
}

}  // namespace

Result<void> report_calibrate(Context& context) {
  const Result<SessionRunner*> gl = context.graphics();
  if (!gl) return gl.error();
  const Scenes what = scenes(context.options.quick);
  context.progress.begin(kCalibratePart,
                         std::size(kManners) * (what.fitted.size() + what.held_out.size()));
  Result<std::vector<ErrorSample>> near = observe(context, what.fitted, what.frames);
  if (!near) return near.error();
  Result<std::vector<ErrorSample>> far = observe(context, what.held_out, what.frames);
  if (!far) return far.error();
  const ErrorModel fitted = fitted_errors(*near, error_model());
  Table table({"scenes", "drawn as", "things", "rank of error (in use)", "of FLIP (in use)",
               "off (in use)", "rank of error (fitted)", "of FLIP (fitted)", "off (fitted)"});
  judge(table, "fitted", *near, fitted);
  judge(table, "held out", *far, fitted);
  Table coefficients({"what is wrong", "in use", "fitted now"});
  for (std::size_t k = 0; k < kWrongs; ++k) {
    coefficients.add({wrong_name(static_cast<Wrong>(k)),
                      fmt::format("{:.4f}", error_model().flip[k]),
                      fmt::format("{:.4f}", fitted.flip[k])});
  }
  Page& page = context.page;
  page.section(kCalibratePart, "Predicted error beside measured");
  page.command(context.options.command_line);
  const RankCorrelation rank = rank_correlation(*far, error_model());
  page.finding({fmt::format("{:.2f}", rank.error),
                "rank correlation of predicted and measured error, scenes held out"});
  page.finding({fmt::format("{:+.3f}", mean_excess(*far, error_model())),
                "measured less predicted FLIP, mean, scenes held out"});
  page.method(fmt::format(
      "Walks of {:g} s at {}x{} over a round trip of 100 ms and 20 Mbit/s in {} manners: budgets "
      "of "
      "{:g} to {:g} ms and none, one sample and four, tiles only, tau 1/2 to 4. Each object that "
      "is "
      "drawn in one way and covers at least {} pixels counts: the FLIP of its pixels against the "
      "full render beside the prediction of client/price/error_model.cpp.",
      (what.frames - 1) / kCalibrateFps, kCalibrateWidth, kCalibrateHeight, std::size(kManners),
      15.0, 150.0, 64));
  page.method(
      "Rank is Spearman's correlation, of the error that is planned by (FLIP times pixels; the "
      "prediction takes the pixels of the disc) and of FLIP a pixel. Off is measured less "
      "predicted "
      "FLIP, the mean over pixels. Coefficients are fitted to the first scenes by least squares "
      "and "
      "judged on the others.");
  context.plot("calibrate", {predicted_beside_measured(*far)}, 1,
               "Each object of the scenes held out: measured against predicted FLIP.");
  page.table(table);
  page.table(coefficients);
  std::printf("%s\n%s", table.csv().c_str(), coefficients.csv().c_str());
  std::vector<ErrorSample> all = near.take();
  for (ErrorSample& sample : *far) all.push_back(std::move(sample));
  return write_file(context.path("calibration.csv"), calibration_csv(all, fitted).csv());
}

}  // namespace mirage
