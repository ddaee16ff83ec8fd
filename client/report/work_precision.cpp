#include "client/report/work_precision.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "client/core/quantile.h"
#include "client/host/methods.h"
#include "client/report/pareto.h"

namespace mirage {
namespace {

constexpr const char* kPart = "work-precision";

// What is run. The swap distance is the same for all methods: nearer than this many radii they all
// draw geometry, so that what differs is the drawing of impostors.
struct Sweep {
  std::vector<std::string> scenes;
  std::vector<double> taus;
  int width, height;
  double fps;
  int frames;
  std::vector<int> compared;  // in pairs, for flicker
};

Sweep sweep(bool quick) {
  if (quick) {
    return {{"builtin:forest?trees=60", "builtin:clutter?objects=150"},
            {4, 1, 0.25},
            240,
            135,
            15,
            121,
            {89, 90, 119, 120}};
  }
  return {{"builtin:forest", "builtin:clutter", "builtin:city", "builtin:museum", "builtin:knot"},
          {8, 4, 2, 1, 0.5, 0.25},
          640,
          360,
          30,
          301,
          {149, 150, 179, 180, 209, 210, 239, 240, 269, 270, 299, 300}};
}

constexpr double kMeshRadii = 4;
constexpr int kDrawsEach = 3;

// 20 Mbit/s for 640x360 pixels, and as much per pixel for a smaller picture: what is asked for
// grows with the picture, so a link of one rate would be no limit for a small one.
NetModel link_for(const Sweep& sweep) {
  NetModel model;
  model.rtt_ms = 100;
  model.rate_mbps = std::round(10 * 20.0 * sweep.width * sweep.height / (640 * 360)) / 10;
  model.server_ms = 5;
  return model;
}

// One setting's figures; n/a where a method has none.
struct Setting {
  std::string method;
  double tau_px = 0;
  double client_ms = 0, client_ms_least = 0;
  std::optional<double> server_ms, display_ms, e1_p99, e1_max;
  double bytes_per_s = 0;
  std::optional<double> flip, psnr, ssim, iou, flicker;
  std::vector<double> spreads;  // slowest over quickest draw, one per compared frame
};

Setting setting_of(const RunSpec& spec, const RunResult& run) {
  Setting s;
  s.method = spec.method;
  s.tau_px = spec.tau_px;
  // The machine's load only ever adds: of each frame its quickest draw.
  std::vector<double> quickest;
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    quickest.push_back(run.frames[i].client_ms);
    const auto first = run.client_ms.begin() + static_cast<std::ptrdiff_t>(i * kDrawsEach);
    s.spreads.push_back(*std::max_element(first, first + kDrawsEach) / run.frames[i].client_ms);
  }
  s.client_ms = quantile(quickest, 0.5);
  s.client_ms_least = quantile(run.client_ms, 0.0);
  std::vector<double> server_ms, display_ms;
  for (const TileLife& life : run.lives) {
    server_ms.push_back(1e-3 * (life.server_render_us + life.server_encode_us));
    if (life.first_drawn_us < 0) continue;
    display_ms.push_back(1e-3 * static_cast<double>(life.first_drawn_us - life.asked_us));
  }
  if (!server_ms.empty()) s.server_ms = quantile(server_ms, 0.5);
  if (!display_ms.empty()) s.display_ms = quantile(display_ms, 0.5);
  if (!run.geometric.errors_px.empty()) {
    s.e1_p99 = quantile(run.geometric.errors_px, 0.99);
    s.e1_max = quantile(run.geometric.errors_px, 1.0);
  }
  s.bytes_per_s = static_cast<double>(run.traffic.bytes_down + run.traffic.bytes_up) / run.seconds;
  MeasureMean flip, psnr, ssim, iou, flicker;
  for (const ComparedFrame& frame : run.frames) {
    flip.add(frame.image.flip_mean);
    psnr.add(frame.image.psnr_db);
    ssim.add(frame.image.ssim);
    iou.add(frame.image.coverage_iou);
    if (frame.flicker) flicker.add(frame.flicker);
  }
  s.flip = flip.mean();
  s.psnr = psnr.mean();
  s.ssim = ssim.mean();
  s.iou = iou.mean();
  s.flicker = flicker.mean();
  return s;
}

struct Floor {
  std::optional<double> flip, iou_error, flicker;
};

// The full render with 2x2 samples against that with 4x4: what no method can be expected to beat.
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

std::vector<bool> fronts(const std::vector<Setting>& settings) {
  std::vector<CostError> points;
  for (const Setting& s : settings) points.push_back({s.client_ms, s.flip.value_or(NAN)});
  return pareto_front(points);
}

using Value = std::function<std::optional<double>(const Setting&)>;
struct Axis {
  const char* label;
  Value value;
};

const std::vector<Axis>& costs() {
  static const std::vector<Axis> axes = {
      {"client, ms per frame", [](const Setting& s) { return s.client_ms; }},
      {"server, ms per tile", [](const Setting& s) { return s.server_ms; }},
      {"both ways, kB/s", [](const Setting& s) { return 1e-3 * s.bytes_per_s; }},
      {"request to display, ms", [](const Setting& s) { return s.display_ms; }}};
  return axes;
}

struct ErrorAxis {
  const char* id;
  const char* label;
  Value value;
  std::function<std::optional<double>(const Floor&)> floor;
};

const std::vector<ErrorAxis>& errors() {
  static const std::vector<ErrorAxis> axes = {
      {"e1", "E1 geometric error p99, px", [](const Setting& s) { return s.e1_p99; },
       [](const Floor&) { return std::optional<double>(); }},
      {"e2", "E2 FLIP, mean", [](const Setting& s) { return s.flip; },
       [](const Floor& f) { return f.flip; }},
      {"e4", "E4 coverage error 1-IoU",
       [](const Setting& s) { return s.iou ? std::optional<double>(1 - *s.iou) : std::nullopt; },
       [](const Floor& f) { return f.iou_error; }},
      {"e6", "E6 flicker, mean", [](const Setting& s) { return s.flicker; },
       [](const Floor& f) { return f.flicker; }}};
  return axes;
}

std::vector<Panel> panels_for(const ErrorAxis& error, const std::vector<Setting>& settings,
                              const std::vector<bool>& front, const Floor& floor) {
  std::vector<Panel> panels;
  for (const Axis& cost : costs()) {
    Panel panel{"", cost.label, error.label, true, true, {}, error.floor(floor), {}};
    for (const std::string& method : method_names()) {
      Series series{method, {}};
      for (const Setting& s : settings) {
        if (s.method != method) continue;
        series.points.emplace_back(cost.value(s).value_or(NAN), error.value(s).value_or(NAN));
      }
      panel.series.push_back(series);
    }
    if (&cost == &costs()[0] && std::string(error.id) == "e2") {
      for (std::size_t i = 0; i < settings.size(); ++i) {
        if (front[i]) panel.front.emplace_back(settings[i].client_ms, *settings[i].flip);
      }
      std::sort(panel.front.begin(), panel.front.end());
    }
    panels.push_back(std::move(panel));
  }
  return panels;
}

void say_who_wins(Page& page, const std::vector<Setting>& settings,
                  const std::vector<bool>& front) {
  std::string on;
  std::vector<std::string> dominated;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Setting& s = settings[i];
    const std::string name = fmt::format("{} at tau {:g} px", s.method, s.tau_px);
    if (front[i]) {
      on += (on.empty() ? "" : ", ") + name;
      continue;
    }
    for (std::size_t k = 0; k < settings.size(); ++k) {
      const Setting& by = settings[k];
      if (!front[k] || by.client_ms > s.client_ms || *by.flip > s.flip.value_or(INFINITY)) continue;
      dominated.push_back(fmt::format(
          "{}: {:.1f} ms, FLIP {:.4f}; {} at tau {:g} px takes {:.1f} ms for {:.4f}", name,
          s.client_ms, s.flip.value_or(NAN), by.method, by.tau_px, by.client_ms, *by.flip));
      break;
    }
  }
  std::vector<double> spreads;
  for (const Setting& s : settings) {
    spreads.insert(spreads.end(), s.spreads.begin(), s.spreads.end());
  }
  page.paragraph("On the Pareto front of client ms against mean FLIP: " + on + ".");
  page.paragraph(
      fmt::format("The slowest of {} draws of one frame takes {:.0f} % longer than the quickest, "
                  "in the median: "
                  "smaller differences of client ms say little.",
                  kDrawsEach, 100 * (quantile(spreads, 0.5) - 1)));
  Table table({"dominated setting"});
  for (const std::string& line : dominated) table.add({line});
  page.folded(fmt::format("{} dominated settings", dominated.size()), table);
}

void add_rows(Table& csv, const OpenScene& scene, const std::string& renderer,
              const std::vector<Setting>& settings, const std::vector<bool>& front) {
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Setting& s = settings[i];
    csv.add({scene.name, s.method, figure(s.tau_px), figure(s.client_ms), figure(s.server_ms),
             figure(s.bytes_per_s), figure(s.display_ms), figure(s.e1_p99), figure(s.e1_max),
             figure(s.flip), figure(s.psnr), figure(s.ssim), figure(s.iou), figure(s.flicker),
             front[i] ? "1" : "0", source_commit(), renderer,
             hex64(scene.truth->scene().revision)});
  }
}

Result<void> one_scene(Context& context, const Sweep& sweep, const std::string& name, Table& csv) {
  const Result<OpenScene*> opened = context.open(name);
  if (!opened) return opened.error();
  OpenScene& scene = **opened;
  SessionRunner& runner = *context.runner;
  RunSpec spec;
  spec.url = scene.url;
  spec.path = scene.path();
  spec.mesh_radii = kMeshRadii;
  spec.net = link_for(sweep);
  spec.width = sweep.width;
  spec.height = sweep.height;
  spec.fps = sweep.fps;
  spec.frames = sweep.frames;
  spec.compared = sweep.compared;
  spec.draws_each = kDrawsEach;
  const Result<Floor> floor = error_floor(spec, *scene.truth);
  if (!floor) return floor.error();
  std::vector<Setting> settings;
  std::vector<std::pair<std::string, Picture>> pictures;
  // Methods beside each other in time: the machine's load drifts.
  for (const double tau : sweep.taus) {
    for (const std::string& method : method_names()) {
      spec.method = method;
      spec.tau_px = tau;
      spec.pictured.clear();
      if (tau == 1) spec.pictured = {spec.compared.back()};
      context.progress.step(fmt::format("{}, {} at tau {:g} px", scene.name, method, tau));
      Result<RunResult> run = runner.run(spec, *scene.truth);
      if (!run) {
        context.omit(kPart, fmt::format("{}, {}, tau {:g}", scene.name, method, tau),
                     run.error().line());
        continue;
      }
      settings.push_back(setting_of(spec, *run));
      for (Picture& picture : run->pictures) pictures.emplace_back(method, std::move(picture));
    }
  }
  scene.truth->forget();
  if (settings.empty()) return {};
  const std::vector<bool> front = fronts(settings);
  add_rows(csv, scene, runner.renderer_name(), settings, front);
  Page& page = context.page;
  page.heading(scene.name);
  say_who_wins(page, settings, front);
  for (const ErrorAxis& error : errors()) {
    const std::size_t index = csv.rows().size();
    context.plot(fmt::format("work_precision_{}_{}", error.id, index),
                 panels_for(error, settings, front, *floor), 2,
                 fmt::format("{}: {} against four costs. One line a method, one point a tau.",
                             scene.name, error.label));
  }
  for (const auto& [method, picture] : pictures) {
    const Result<void> shown =
        page.pictures(fmt::format("{}, {} at tau 1 px: as drawn, full render, difference times 2",
                                  scene.name, method),
                      picture);
    if (!shown) return shown;
  }
  return {};
}

void explain(Context& context, const Sweep& sweep) {
  Page& page = context.page;
  page.section(kPart, "Error against run time");
  page.command(context.options.command_line);
  page.paragraph(fmt::format(
      "How it was measured: a walk (around a single object: an orbit) of {:.1f} s at {:g} frames a "
      "second, {}x{} pixels, 100 ms round "
      "trip, {:g} Mbit/s, 5 ms of server time granted per tile on virtual time; {} frames compared "
      "with the full render at 4x4 samples per pixel. Every method and tau runs the same session; "
      "all draw geometry nearer than {:g} radii and for what surrounds the viewer, so they differ "
      "in how they draw impostors. auto also draws as geometry whatever costs fewer bytes than one "
      "tile; mesh draws nothing but geometry and has no tiles, hence no server or display time; "
      "fixed8 is the classic baseline, eight views around the horizon on flat quads.",
      sweep.frames / sweep.fps, sweep.fps, sweep.width, sweep.height, link_for(sweep).rate_mbps,
      sweep.compared.size(), kMeshRadii));
  page.paragraph(fmt::format(
      "client ms: planning, drawing and finishing one frame, {}; each compared frame is drawn {} "
      "times and counts with its quickest draw, of which the median is given; the first draw of a "
      "run is apart (compilation). server ms per tile: rendering and encoding, median. bytes: both "
      "ways, framing and the scene's description included. request to display: median, on the "
      "modelled link. E1: by reprojecting the reference's depth. FLIP at 67.02 pixels per degree, "
      "on the pixels that show an object in either picture, grown by 2. The error floor is the "
      "full "
      "render at 2x2 samples against that at 4x4: what sampling alone does.",
      context.runner->software() ? "CPU time over all threads (a software renderer)" : "wall time",
      kDrawsEach));
}

}  // namespace

Result<void> report_work_precision(Context& context) {
  const Result<SessionRunner*> gl = context.graphics();
  if (!gl) return gl.error();
  const Sweep what = sweep(context.options.quick);
  explain(context, what);
  Table csv({"scene", "method", "tau_px", "client_ms", "server_ms_per_tile", "bytes_per_s",
             "request_to_display_ms", "e1_px_p99", "e1_px_max", "flip_mean", "psnr_db", "ssim",
             "iou", "flicker", "pareto", "commit", "renderer", "revision"});
  const std::vector<std::string> scenes = context.scenes_or(what.scenes);
  context.progress.begin(kPart, scenes.size() * method_names().size() * what.taus.size());
  for (const std::string& scene : scenes) {
    if (Result<void> done = one_scene(context, what, scene, csv); !done) return done;
  }
  std::vector<bool> marked;
  for (const auto& row : csv.rows()) marked.push_back(row[csv.column("pareto")] == "1");
  context.page.heading("All settings (on the front: set off)");
  context.page.table(csv, marked);
  return write_file(context.path("work_precision.csv"), csv.csv());
}

}  // namespace mirage
