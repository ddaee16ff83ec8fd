#include "client/report/weather.h"

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <set>

#include "client/price/cost_model.h"
#include "client/report/session_run.h"
#include "client/report/weather_rows.h"
#include "protocol/base/quantile.h"
#include "protocol/base/result.h"
#include "protocol/quality/metrics.h"

namespace mirage {
namespace {

constexpr const char* kWeatherPart = "weather";
constexpr int kWidth = 480, kHeight = 270;
constexpr double kFps = 8;
constexpr int kCompareEvery = 8;  // frames

// Size of the table that is run.
struct Extent {
  std::uint64_t seeds;
  int frames;
};
Extent extent(bool quick) { return quick ? Extent{1, 33} : Extent{3, 65}; }

// Settings that are the same for all runs.
struct Settings {
  Extent extent;
  std::vector<double> budgets_ms;  // 0: no budget
  int samples;                     // of a drawn pixel; < 0: as many as pay, 4 without a budget
};

Settings settings(const ReportOptions& options) {
  if (options.frame_ms <= 0) return {extent(options.quick), {0}, 1};
  return {extent(options.quick), {0, options.frame_ms}, -1};
}

RunSpec spec_of(const Weather& weather, const std::string& url, std::uint64_t seed,
                double budget_ms, const Settings& settings) {
  const int frames = settings.extent.frames;
  RunSpec spec;
  spec.url = url;
  spec.path = weather.path;
  spec.net = weather.net;
  spec.net.seed = seed;
  spec.width = kWidth;
  spec.height = kHeight;
  spec.samples = settings.samples;
  spec.frame_ms = budget_ms;
  spec.device = device_model("software");
  spec.fps = kFps;
  spec.frames = frames;
  spec.from_scene = true;
  for (int f = kCompareEvery; f < frames; f += kCompareEvery) spec.compared.push_back(f);
  return spec;
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

double client_ms_p95(const RunResult& result) {
  std::vector<double> ms;
  for (auto i = static_cast<std::size_t>(kFps); i < result.planned.size(); ++i) {
    ms.push_back(result.planned[i].model_ms);
  }
  return quantile(ms, 0.95);
}

WeatherRun run_of(const Weather& weather, std::uint64_t seed, double budget_ms,
                  const RunResult& result) {
  WeatherRun run;
  run.weather = weather;
  run.seed = seed;
  run.budget_ms = budget_ms;
  run.client_ms_p95 = client_ms_p95(result);
  MeasureMean flip, psnr;
  for (const ComparedFrame& frame : result.frames) {
    flip.add(frame.image.flip_mean);
    psnr.add(frame.image.psnr_db);
    if (!frame.image.flip_mean) continue;
    run.flip.emplace_back(frame.frame / kFps, *frame.image.flip_mean);
    run.flip_worst = std::fmax(run.flip_worst, *frame.image.flip_mean);
  }
  run.flip_mean = flip.mean().value_or(NAN);
  run.psnr_db = psnr.mean().value_or(NAN);
  run.hole_fraction = share(result.geometric.holes, result.geometric.object_pixels);
  run.no_image_fraction = share(result.placeholders, result.visible);
  run.starved_fraction = share(result.starved, result.planned.size());
  run.mb = 1e-6 * static_cast<double>(result.traffic.bytes_down);
  const auto both_ways = static_cast<double>(result.traffic.bytes_down + result.traffic.bytes_up);
  run.link_used = 8e-6 * both_ways / result.seconds / weather.net.rate_mbps;
  run.bound_violations = result.geometric.violations;
  return run;
}

std::string within(double budget_ms) {
  return budget_ms > 0 ? fmt::format(", within {:g} ms", budget_ms) : "";
}

void say(const WeatherRun& run) {
  std::printf(
      "%s, seed %d%s: FLIP %.4f, worst %.4f, %.1f dB, holes %.4f, no image %.3f, starved %.3f, "
      "%.2f MB, %.0f %% of the link, %d px over bound, client %.0f ms p95\n",
      run.weather.name.c_str(), static_cast<int>(run.seed), within(run.budget_ms).c_str(),
      run.flip_mean, run.flip_worst, run.psnr_db, run.hole_fraction, run.no_image_fraction,
      run.starved_fraction, run.mb, 100 * run.link_used, static_cast<int>(run.bound_violations),
      run.client_ms_p95);
  std::fflush(stdout);
}

// Runs one weather with one seed, by every budget.
Result<void> run_weather(Context& context, const Weather& weather, std::uint64_t seed,
                         const Settings& settings, std::vector<WeatherRun>& out) {
  const std::string name = seeded(weather.scene, seed);
  const Result<OpenScene*> scene = context.open(name);
  if (!scene) return scene.error();
  for (const double budget : settings.budgets_ms) {
    const std::string what =
        fmt::format("{}, {}, seed {}{}", weather.name, name, seed, within(budget));
    context.progress.step(what);
    const Result<RunResult> result = context.runner->run(
        spec_of(weather, (*scene)->url, seed, budget, settings), *(*scene)->truth);
    if (!result) {
      context.omit(kWeatherPart, what, result.error().line());
      continue;
    }
    out.push_back(run_of(weather, seed, budget, *result));
    say(out.back());
  }
  return {};
}

// Runs all weathers with one seed. Weathers on one scene and path share its full renders.
Result<void> run_seed(Context& context, const std::vector<Weather>& weathers, std::uint64_t seed,
                      const Settings& settings, std::vector<WeatherRun>& out) {
  std::set<std::string> opened;
  for (const Weather& weather : weathers) {
    opened.insert(seeded(weather.scene, seed));
    if (Result<void> done = run_weather(context, weather, seed, settings, out); !done) return done;
  }
  for (const std::string& name : opened) context.close(name);
  return {};
}

void explain(Context& context, const Settings& settings) {
  const Extent& extent = settings.extent;
  Page& page = context.page;
  page.section(kWeatherPart, "Ten kinds of weather");
  page.command(context.options.command_line);
  page.method(fmt::format(
      "A session as mirage-view has it (auto, tau 1 px) for each weather and each of {} seed{}, of "
      "the scene and of the link's chances. It runs on virtual time over a modelled link for {:g} "
      "s at {:g} frames a second and {}x{} pixels, {}. Every {}th frame is compared with the full "
      "render at 4x4 samples. Time 0 is when the scene is known; what comes before has a section "
      "of its own. Where nothing else is said, a figure is the median over seeds.",
      extent.seeds, extent.seeds > 1 ? "s" : "", (extent.frames - 1) / kFps, kFps, kWidth, kHeight,
      settings.samples > 0 ? "one sample a pixel"
                           : "as many samples a pixel as pay within the budget, 4 without one",
      kCompareEvery));
  page.method(
      "Starved counts the frames in which a first image waited to be asked for while neither the "
      "link (80 %) nor the server (90 %) was busy. Client time is that of the device model "
      "'software', from the second second on. Over bound counts pixels of impostors whose true "
      "error exceeds the bound that they were drawn with.");
}

void show_table(Context& context, const Table& table) {
  std::vector<bool> marked(table.rows().size(), false);
  marked[marked.size() - 2] = marked[marked.size() - 1] = true;
  context.page.table(table, marked);
}

void say_found(Page& page, const std::vector<WeatherRun>& runs, std::uint64_t violations) {
  std::vector<double> flip, starved;
  const WeatherRun* worst = &runs.front();
  for (const WeatherRun& run : runs) {
    flip.push_back(run.flip_mean);
    starved.push_back(run.starved_fraction);
    if (run.flip_mean > worst->flip_mean) worst = &run;
  }
  page.finding({fmt::format("{:.3f}", quantile(flip, 0.5)), "FLIP, median of all runs"});
  page.finding({fmt::format("{:.3f}", worst->flip_mean),
                fmt::format("FLIP, worst run: {}, seed {}", worst->weather.name, worst->seed)});
  page.finding({std::to_string(violations), "pixels beyond their bound", violations > 0});
  page.finding({fmt::format("{:.2f}", quantile(starved, 0.5)),
                "of the frames first images waited while link and server were idle, median"});
}

void show(Context& context, const Settings& settings, const std::vector<WeatherRun>& runs) {
  if (settings.budgets_ms.size() > 1) {
    context.page.heading(fmt::format("No budget, and within {:g} ms", settings.budgets_ms.back()));
    show_table(context, weather_budget_table(runs));
  }
  for (const double budget : settings.budgets_ms) {
    std::vector<WeatherRun> of_budget;
    for (const WeatherRun& run : runs) {
      if (run.budget_ms == budget) of_budget.push_back(run);
    }
    if (of_budget.empty()) continue;
    context.page.heading(budget > 0 ? fmt::format("Within {:g} ms", budget) : "No budget");
    context.plot(fmt::format("weather_{:g}", budget), weather_panels(of_budget), 2,
                 "FLIP over time, a line for each weather: the median over seeds.");
    show_table(context, weather_table(of_budget));
  }
  std::uint64_t violations = 0;
  for (const WeatherRun& run : runs) violations += run.bound_violations;
  say_found(context.page, runs, violations);
  if (violations == 0) return;
  context.failed_checks.push_back(
      fmt::format("weather: {} pixels of impostors exceed their bound", violations));
}

}  // namespace

Result<void> report_weather(Context& context) {
  const Result<SessionRunner*> gl = context.graphics();
  if (!gl) return gl.error();
  const Settings what = settings(context.options);
  explain(context, what);
  const std::string scene = context.scenes_or({""}).front();
  const std::vector<Weather> weathers = weathers_on(scene);
  if (weathers.empty()) {
    context.omit(kWeatherPart, scene, "no weather of the table is on this scene");
  }
  context.progress.begin(kWeatherPart,
                         weathers.size() * what.extent.seeds * what.budgets_ms.size());
  std::vector<WeatherRun> runs;
  for (std::uint64_t seed = 1; seed <= what.extent.seeds; ++seed) {
    const Result<void> done = run_seed(context, weathers, seed, what, runs);
    if (!done) return done;
  }
  if (!runs.empty()) show(context, what, runs);
  return write_file(context.path("weather.csv"), weather_csv(runs).csv());
}

}  // namespace mirage
