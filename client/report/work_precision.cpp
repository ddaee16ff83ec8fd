#include "client/report/work_precision.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>

#include "client/frame/camera_path.h"
#include "client/host/methods.h"
#include "client/link/net_model.h"
#include "client/report/session_run.h"
#include "client/report/truth_source.h"
#include "client/report/work_precision_rows.h"
#include "client/scene/scene_view.h"
#include "client/session/tile_trace.h"
#include "protocol/base/quantile.h"
#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "protocol/quality/image_view.h"
#include "protocol/quality/metrics.h"

namespace mirage {
namespace {

constexpr const char* kWorkPrecisionPart = "work-precision";
constexpr const char* kDevice = "software";  // budgets are judged by its prices
constexpr int kDrawsEach = 2;
// Nearer than this many radii all fixed methods draw geometry, so that only the drawing of
// impostors differs. auto decides by itself, within the viewer's default.
constexpr double kMeshRadii = 4;
constexpr double kFromS = 1;  // earlier frames do not count for the 95th percentile

// Returns a link of 20 Mbit/s for 640x360 pixels, and as much per pixel for a smaller picture.
// Needs grow with the picture, so a link of one rate would be no limit for a small one.
NetModel link_for(const Sweep& sweep) {
  NetModel model;
  model.rtt_ms = 100;
  model.rate_mbps = std::round(10 * 20.0 * sweep.width * sweep.height / (640 * 360)) / 10;
  model.server_ms = 5;
  return model;
}

RunSpec spec_of(const Sweep& sweep, const OpenScene& scene, const Setting& setting) {
  RunSpec spec;
  spec.url = scene.url;
  spec.path = scene.path();
  spec.method = setting.method;
  spec.tau_px = setting.tau_px;
  spec.samples = setting.samples;
  spec.frame_ms = setting.budget_ms;
  spec.device = device_model(kDevice);
  spec.mesh_radii = setting.automatic() ? kSwapRadii : kMeshRadii;
  spec.net = link_for(sweep);
  spec.width = sweep.width;
  spec.height = sweep.height;
  spec.fps = sweep.fps;
  spec.frames = sweep.frames;
  spec.compared = sweep.compared;
  spec.draws_each = kDrawsEach;
  if (setting.pictured) spec.pictured = {spec.compared.back()};
  return spec;
}

void add_times(const Sweep& sweep, const RunResult& run, Figures& f) {
  // The machine's load can only add time, so each frame counts with its quickest draw.
  std::vector<double> quickest;
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    quickest.push_back(run.frames[i].client_ms);
    const auto first = run.client_ms.begin() + static_cast<std::ptrdiff_t>(i * kDrawsEach);
    f.spreads.push_back(*std::max_element(first, first + kDrawsEach) / run.frames[i].client_ms);
  }
  f.client_ms = quantile(quickest, 0.5);
  std::vector<double> model_ms;
  std::vector<std::pair<FrameSetting, int>> uses;
  for (std::size_t i = static_cast<std::size_t>(kFromS * sweep.fps); i < run.planned.size(); ++i) {
    const PricedFrame& frame = run.planned[i];
    model_ms.push_back(frame.model_ms);
    auto use = std::find_if(uses.begin(), uses.end(),
                            [&](const auto& u) { return u.first == frame.setting; });
    if (use == uses.end()) use = uses.insert(use, {frame.setting, 0});
    ++use->second;
  }
  if (model_ms.empty()) return;
  f.client_ms_p95 = quantile(model_ms, 0.95);
  f.frame_setting = std::max_element(uses.begin(), uses.end(), [](const auto& a, const auto& b) {
                      return a.second < b.second;
                    })->first;
}

Figures figures_of(const Sweep& sweep, const Setting& setting, const RunResult& run) {
  Figures f;
  f.setting = setting;
  add_times(sweep, run, f);
  std::vector<double> server_ms, display_ms;
  for (const TileLife& life : run.lives) {
    server_ms.push_back(1e-3 * (life.server_render_us + life.server_encode_us));
    if (life.first_drawn_us < 0) continue;
    display_ms.push_back(1e-3 * static_cast<double>(life.first_drawn_us - life.asked_us));
  }
  if (!server_ms.empty()) f.server_ms = quantile(server_ms, 0.5);
  if (!display_ms.empty()) f.display_ms = quantile(display_ms, 0.5);
  if (!run.geometric.errors_px.empty()) {
    f.e1_p99 = quantile(run.geometric.errors_px, 0.99);
    f.e1_max = quantile(run.geometric.errors_px, 1.0);
  }
  f.bytes_per_s = static_cast<double>(run.traffic.bytes_down + run.traffic.bytes_up) / run.seconds;
  MeasureMean flip, psnr, ssim, iou, flicker;
  for (const ComparedFrame& frame : run.frames) {
    flip.add(frame.image.flip_mean);
    psnr.add(frame.image.psnr_db);
    ssim.add(frame.image.ssim);
    iou.add(frame.image.coverage_iou);
    if (frame.flicker) flicker.add(frame.flicker);
  }
  f.flip = flip.mean();
  f.psnr = psnr.mean();
  f.ssim = ssim.mean();
  f.iou = iou.mean();
  f.flicker = flicker.mean();
  return f;
}

// Returns the error of the full render with 2x2 samples against that with 4x4. No method can be
// expected to be better.
Result<Floor> error_floor(const RunSpec& spec, TruthSource& truth) {
  const SceneView& scene = truth.scene();
  const Result<CameraPath> path =
      CameraPath::create(spec.path, scene.home, scene.bounds_center, scene.bounds_radius);
  if (!path) return path.error();
  MeasureMean flip, iou, flick;
  ReferencePtr coarse_before, fine_before;
  int before = -2;
  for (const int frame : spec.compared) {
    const Camera camera =
        SessionRunner::camera_at(*path, frame / spec.fps, scene, spec.width, spec.height);
    const Result<ReferencePtr> coarse = truth.at(camera, 2), fine = truth.at(camera, 4);
    if (!coarse) return coarse.error();
    if (!fine) return fine.error();
    const auto view = [&](const ReferencePtr& r) {
      return ImageView{camera.width, camera.height, r->rgba.data()};
    };
    const ImageMeasures m = measure_images(view(*fine), view(*coarse));
    flip.add(m.flip_mean);
    iou.add(m.coverage_iou);
    if (before + 1 == frame) {
      flick.add(flicker(view(fine_before), view(coarse_before), view(*fine), view(*coarse)));
    }
    before = frame;
    coarse_before = *coarse;
    fine_before = *fine;
  }
  Floor floor{flip.mean(), std::nullopt, flick.mean()};
  if (iou.mean()) floor.iou_error = 1 - *iou.mean();
  return floor;
}

/// Returns the best of auto's settings that `chosen` accepts, by FLIP; nullptr: there is none.
const Figures* best_auto(const std::vector<Figures>& all,
                         const std::function<bool(const Setting&)>& chosen) {
  const Figures* best = nullptr;
  for (const Figures& f : all) {
    if (!f.setting.automatic() || !f.flip || !chosen(f.setting)) continue;
    if (!best || *f.flip < *best->flip) best = &f;
  }
  return best;
}

/// The costs that auto is judged by, each with the relative difference that counts as none.
std::vector<std::pair<Cost, double>> costs_with_slack(const std::vector<Figures>& all) {
  return {{Cost::kClientMs, spread_of(all)}, {Cost::kModelMs, 0}, {Cost::kBytesPerS, 0}};
}

void say_who_wins(Page& page, const std::string& scene, const std::vector<Figures>& all) {
  if (const Figures* f = best_auto(all, [](const Setting& s) { return s.budget_ms == 0; })) {
    page.finding({fmt::format("{:.3f}", *f->flip), "FLIP of " + scene + ", no budget"});
  }
  double budget = 0;
  for (const Figures& f : all) {
    if (f.setting.automatic()) budget = std::max(budget, f.setting.budget_ms);
  }
  const Figures* held = best_auto(all, [&](const Setting& s) { return s.budget_ms == budget; });
  if (held && budget > 0) {
    page.finding({fmt::format("{:.3f}", *held->flip),
                  fmt::format("FLIP of {} within {:g} ms a frame", scene, budget)});
  }
  const auto fixed = std::count_if(all.begin(), all.end(),
                                   [](const Figures& f) { return !f.setting.automatic(); });
  const std::size_t cheaper = left_of_auto(all, Cost::kClientMs, spread_of(all)).size();
  page.finding({fmt::format("{} of {}", cheaper, fixed),
                "fixed settings show the same FLIP of " + scene + " in less client time than auto",
                cheaper > 0});
  for (const auto& [cost, slack] : costs_with_slack(all)) {
    if (left_of_auto(all, cost, slack).empty()) continue;
    std::string said = say_of_auto(all, cost, slack);
    said = said.substr(0, said.find(':'));  // what follows is a list, which stands below the plots
    said[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(said[0])));
    page.falls_short(scene + ": " + said + ".");
  }
}

void show_settings(Page& page, const std::vector<Figures>& all) {
  for (const auto& [cost, slack] : costs_with_slack(all)) {
    page.paragraph(say_of_auto(all, cost, slack));
  }
  const std::vector<bool> front = front_by(all, Cost::kClientMs);
  std::string on;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (front[i]) on += (on.empty() ? "" : ", ") + all[i].setting.name();
  }
  page.paragraph(
      "No other setting is both quicker and better than these (the Pareto front of "
      "client time against FLIP): " +
      on + ".");
  page.paragraph(
      fmt::format("Each frame is drawn {} times. The slowest draw takes {:.0f} % longer than the "
                  "quickest, in the median: smaller differences of client time say little.",
                  kDrawsEach, 100 * spread_of(all)));
  const Table dominated = dominated_settings(all);
  page.folded(fmt::format("{} settings that another one beats", dominated.rows().size()),
              dominated);
}

Result<void> show(Context& context, const OpenScene& scene, const std::vector<Figures>& all,
                  const Floor& floor, std::size_t index,
                  const std::vector<std::pair<Setting, Picture>>& pictures) {
  Page& page = context.page;
  page.heading(scene.name);
  say_who_wins(page, scene.name, all);
  for (const ErrorPlot& plot : error_plots(all, floor)) {
    context.plot(fmt::format("work_precision_{}_{}", plot.id, index), plot.panels, 2,
                 fmt::format("{}: {} against four costs; lower left is better. Filled points: 4 "
                             "samples a pixel, and auto without a budget, one point for each tau. "
                             "Open points: 1 sample a pixel, and auto by budget.",
                             scene.name, plot.label));
  }
  show_settings(page, all);
  for (const auto& [setting, picture] : pictures) {
    const Result<void> shown =
        page.pictures(fmt::format("{}, {}.", scene.name, setting.name()), picture);
    if (!shown) return shown;
  }
  return {};
}

// Lets the server render the home view once for all, so that no run is the first.
Result<void> keep_home_view(Context& context, const Sweep& sweep, OpenScene& scene) {
  RunSpec spec = spec_of(sweep, scene, {"auto"});
  spec.frames = 1;
  spec.from_scene = true;
  spec.compared.clear();
  const Result<RunResult> run = context.runner->run(spec, *scene.truth);
  return run ? Result<void>{} : run.error();
}

Result<void> one_scene(Context& context, const Sweep& sweep, const std::string& name, Table& csv) {
  const Result<OpenScene*> opened = context.open_own(kWorkPrecisionPart, name);
  if (!opened) return opened.error();
  if (!*opened) return {};
  OpenScene& scene = **opened;
  const Result<Floor> floor = error_floor(spec_of(sweep, scene, {}), *scene.truth);
  if (!floor) return floor.error();
  if (Result<void> kept = keep_home_view(context, sweep, scene); !kept) return kept;
  std::vector<Figures> all;
  std::vector<std::pair<Setting, Picture>> pictures;
  for (const Setting& setting : sweep.settings) {
    context.progress.step(fmt::format("{}, {}", scene.name, setting.name()));
    Result<RunResult> run = context.runner->run(spec_of(sweep, scene, setting), *scene.truth);
    if (!run) {
      context.omit(kWorkPrecisionPart, scene.name + ", " + setting.name(), run.error().line());
      continue;
    }
    all.push_back(figures_of(sweep, setting, *run));
    for (Picture& picture : run->pictures) pictures.emplace_back(setting, std::move(picture));
  }
  scene.truth->forget();
  if (all.empty()) return {};
  add_rows(csv, all,
           {scene.name, source_commit(), context.runner->renderer_name(),
            hex64(scene.truth->scene().revision)});
  return show(context, scene, all, *floor, csv.rows().size(), pictures);
}

void explain(Context& context, const Sweep& sweep) {
  Page& page = context.page;
  page.section(kWorkPrecisionPart, "Error against run time");
  page.command(context.options.command_line);
  page.method(fmt::format(
      "Each method, tau and budget runs the same session: a walk, or an orbit around a single "
      "object, of {:.1f} s at {:g} frames a second and {}x{} pixels. The modelled link has a round "
      "trip of 100 ms and {:g} Mbit/s; the server is granted 5 ms of virtual time for a tile. {} "
      "frames are compared with the full render at 4x4 samples a pixel.",
      sweep.frames / sweep.fps, sweep.fps, sweep.width, sweep.height, link_for(sweep).rate_mbps,
      sweep.compared.size()));
  page.method(fmt::format(
      "Fixed methods differ in how they draw impostors. All of them draw geometry nearer than {:g} "
      "radii and for what surrounds the viewer. The method mesh draws geometry only and has no "
      "tiles. The method fixed8 is the classic baseline: eight views around the horizon on flat "
      "quads.",
      kMeshRadii));
  page.method(fmt::format(
      "auto is what mirage-view does by default. Within a budget of ms a frame (--frame-ms, held "
      "by the device model '{}') it chooses geometry, marching, 1 or 4 samples a pixel and the "
      "scale for each frame. Without a budget it draws 4 samples and geometry within {:g} radii. A "
      "fixed method cannot choose samples, which are the largest part of its price. So each is run "
      "with 1 sample and, at tau 1 px, with 4, and auto has to be as good as the better of the "
      "two. A fixed setting is left of auto if it shows the same FLIP at a lower cost than auto.",
      kDevice, kSwapRadii));
  page.method(fmt::format(
      "Client time: planning, drawing and finishing one frame, {}. Each compared frame is drawn {} "
      "times and counts with its quickest draw; the table has the median. The first draw of a run "
      "is left out, because it compiles shaders. Client p95, scale and samples count all frames "
      "from the second second on. Server time: rendering and encoding. Bytes: both ways, with "
      "framing and the description of the scene. Position error (E1): from the depth of the full "
      "render. FLIP: at 67.02 pixels a degree, on the pixels that show an object in either "
      "picture, grown by 2. The error floor is the full render at 2x2 samples beside that at 4x4, "
      "so what sampling alone does.",
      context.runner->software() ? "as CPU time over all threads (a software renderer)"
                                 : "as wall time",
      kDrawsEach));
}

}  // namespace

Result<void> report_work_precision(Context& context) {
  const Result<SessionRunner*> gl = context.graphics();
  if (!gl) return gl.error();
  const Sweep what = work_sweep(context.options.quick, method_names());
  explain(context, what);
  Table csv = work_precision_table();
  const std::vector<std::string> scenes = context.scenes_or(what.scenes);
  context.progress.begin(kWorkPrecisionPart, scenes.size() * what.settings.size());
  for (const std::string& scene : scenes) {
    if (Result<void> done = one_scene(context, what, scene, csv); !done) return done;
  }
  std::vector<bool> marked;
  for (const auto& row : csv.rows()) marked.push_back(row[csv.column("pareto")] == "1");
  context.page.heading("All settings (those on the front are set off)");
  context.page.table(csv, marked);
  return write_file(context.path("work_precision.csv"), csv.csv());
}

}  // namespace mirage
