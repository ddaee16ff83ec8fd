#include "client/report/fidelity.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "client/draw/refinement.h"
#include "client/frame/draw_list.h"
#include "client/frame/planned_frame.h"
#include "client/report/alpha_tested.h"
#include "client/report/codecs.h"
#include "client/report/session_run.h"
#include "client/report/tile_probe.h"
#include "client/report/truth_source.h"
#include "protocol/base/stable_math.h"
#include "protocol/quality/metrics.h"

namespace mirage {
namespace {

using nlohmann::ordered_json;

constexpr const char* kFidelityPart = "fidelity";
constexpr int kEdge = 512;
constexpr int kDirections = 24;
constexpr double kDegree = 0.017453292519943295;

struct Model {
  std::string name, spec, light;  // light: lit or albedo
  bool published;
  bool alpha_test = false;  // tests alpha of blended materials, too, as the protocol does
};

// A line of the table: captured `offset_deg` beside the eye, drawn with a method.
struct Setting {
  double radii, offset_deg;
  std::string method;
};

struct Row {
  Model model;
  Setting setting;
  std::optional<double> psnr_db, ssim, iou;
  std::size_t texture_bytes = 0;
};

// Published figures of the field, for grids of 12 x 12 views in 2048 x 2048 texels.
struct Published {
  const char *model, *grid;
  double radii, psnr_db, ssim, iou, mib;
};
constexpr double kSmallGridMiB = 42.7, kLargeGridMiB = 171;
const Published kPublished[] = {{"knot", "12 x 12", 2.5, 15.5, .694, .80, kSmallGridMiB},
                                {"knot", "12 x 12", 4, 17.3, .751, .87, kSmallGridMiB},
                                {"knot", "12 x 12", 12, 20.2, .827, .94, kSmallGridMiB},
                                {"knot", "12 x 12", 40, 21.0, .842, .94, kSmallGridMiB},
                                {"knot", "16 x 16", 4, 17.5, .768, .87, kLargeGridMiB},
                                {"monkey", "12 x 12", 4, 18.0, .765, .89, kSmallGridMiB},
                                {"tree", "12 x 12", 4, 16.1, .44, .77, kSmallGridMiB},
                                {"tree", "12 x 12", 40, 17.4, .49, .82, kSmallGridMiB}};

// Returns the light of the protocol. three.js divides both kinds by pi (BRDF_Lambert). Here a
// light's colour is irradiance per pi already, and ambient is the radiance of a white surface.
Lighting field_light(const std::string& light) {
  constexpr float kPi = 3.14159265f;
  Lighting lighting;
  lighting.ambient = glm::vec3(light == "lit" ? 0.6f / kPi : 1.0f);
  if (light != "lit") return lighting;
  Light sun;
  sun.color = glm::vec3(2.5f / kPi);
  sun.direction = -glm::normalize(glm::vec3(2, 3, 1));
  lighting.lights = {sun};
  return lighting;
}

// Returns direction i of 24: elevations from 5 degrees up, evenly over the sphere.
glm::dvec3 field_direction(int i) {
  const double s = std::sin(5.0 * kDegree);
  const double y = s + (1.0 - s) * (i + 0.5) / kDirections;
  const double azimuth = 2.399963 * i, ring = std::sqrt(1.0 - y * y);
  return {ring * std::cos(azimuth), y, ring * std::sin(azimuth)};
}

glm::dvec3 turned(const glm::dvec3& direction, double degrees, double bearing) {
  const glm::dvec3 any = std::abs(direction.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 a = glm::normalize(glm::cross(any, direction));
  const glm::dvec3 b = glm::cross(direction, a);
  const double angle = degrees * kDegree;
  return std::cos(angle) * direction +
         std::sin(angle) * (std::cos(bearing) * a + std::sin(bearing) * b);
}

Camera field_camera(const SceneView& scene, double radii, const glm::dvec3& direction) {
  const double r = scene.bounds_radius, d = radii * r;
  Camera camera;
  camera.width = camera.height = kEdge;
  camera.fov_y = 2.0 * std::atan(1.05 * r / tangent_length(d, r));
  camera.pose = look_at(scene.bounds_center + direction * d, scene.bounds_center);
  camera.fit_depth_range(scene.bounds_center, r);
  return camera;
}

std::vector<Setting> settings(const Model& model, bool quick) {
  // The quick form uses only distances for which there is a published figure.
  std::vector<double> distances = {2.5, 4.0, 12.0, 40.0};
  if (quick && model.name == "monkey") distances = {4.0};
  if (quick && model.name == "tree") distances = {4.0, 40.0};
  std::vector<Setting> out;
  out.reserve(16);
  for (const double radii : distances) out.push_back({radii, 0, "quad"});
  out.push_back({4, 0, "at rest"});  // the same quad, refined like a viewer's picture at rest
  for (const double degrees : {5.0, 10.0}) {
    for (const char* method : {"quad", "warp", "depth"}) out.push_back({4, degrees, method});
  }
  // Eight views: the offset is the nearest view's.
  if (model.published) out.push_back({4, NAN, "fixed8"});
  return out;
}

DrawMethod method_of(const std::string& name) {
  return name == "depth"  ? DrawMethod::kDepth
         : name == "warp" ? DrawMethod::kWarp
                          : DrawMethod::kQuad;
}

// Returns the path of a shared model beside the checkout; empty: it is not there.
std::string shared_model(const std::string& file) {
  const char* set = std::getenv("MIRAGE_SHARED");
  const std::string path = std::string(set ? set : "../shared") + "/assets/reference/" + file;
  std::error_code failed;
  return std::filesystem::exists(path, failed) ? path : "";
}

std::vector<Model> models(Context& context) {
  const ReportOptions& o = context.options;
  const std::string own = !o.model.empty() ? o.model : !o.scene.empty() ? o.scene : o.url;
  if (!own.empty()) return {{own, own, "lit", false}};
  std::vector<Model> out = {{"knot", "builtin:knot", "lit", true}};
  const Model shared[] = {{"monkey", "monkey.glb", "lit", true},
                          {"tree", "tree.glb", "albedo", true, true}};
  for (Model model : shared) {
    const std::string path = shared_model(model.spec);
    if (path.empty()) {
      context.omit(kFidelityPart, model.name,
                   model.spec + " is not beside the checkout (MIRAGE_SHARED)");
      continue;
    }
    model.spec = path;
    out.push_back(model);
  }
  return out;
}

// Opens the model. A model that is to be alpha-tested is opened from a changed copy.
Result<OpenScene*> open_model(Context& context, const Model& model) {
  if (!model.alpha_test) return context.open(model.spec);
  std::ifstream file(model.spec, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  const Result<std::vector<std::uint8_t>> changed = alpha_tested(bytes);
  if (!changed) return changed.error();
  const std::string copy = context.path(model.name + "_alpha_tested.glb");
  const Result<void> written = write_file(copy, {changed->begin(), changed->end()});
  if (!written) return written.error();
  const Result<OpenScene*> scene = context.open(copy);
  std::error_code ignored;
  std::filesystem::remove(copy, ignored);
  return scene;
}

struct Bench {
  SessionRunner& runner;
  FrameTarget target;
  std::unique_ptr<TileProbe> probe;
  TruthSource& truth;
  Refinement refinement{};
};

Result<Row> measure(Bench& bench, const Model& model, const Setting& setting, int step,
                    std::optional<Picture>& picture) {
  const SceneView& scene = bench.probe->scene();
  MeasureMean psnr, ssim, iou;
  Row row{model, setting, {}, {}, {}};
  for (int i = 0; i < kDirections; i += step) {
    const glm::dvec3 direction = field_direction(i);
    const Camera camera = field_camera(scene, setting.radii, direction);
    const double aside = std::isnan(setting.offset_deg) ? 0 : setting.offset_deg;
    const Camera from = field_camera(scene, setting.radii, turned(direction, aside, 2.4 * i));
    const Result<DrawList> list =
        setting.method == "fixed8" ? bench.probe->eight_views(camera)
                                   : bench.probe->capture(from, camera, method_of(setting.method));
    if (!list) return list.error();
    FrameRenderer& renderer = bench.runner.renderer();
    const PlannedFrame frame{camera, &scene, *list, bench.probe->lighting()};
    renderer.draw(bench.target, frame);
    bench.refinement.restart();
    if (setting.method == "at rest") {
      while (!bench.refinement.done()) {
        bench.refinement.draw_more(renderer, bench.target, frame);
      }
    }
    const std::vector<std::uint8_t> drawn = bench.refinement.picture(bench.target).read();
    const Result<ReferencePtr> truth = bench.truth.at(camera, 4);
    if (!truth) return truth.error();
    const FieldFidelity f =
        field_fidelity({kEdge, kEdge, (*truth)->rgba.data()}, {kEdge, kEdge, drawn.data()});
    psnr.add(f.psnr_db);
    ssim.add(f.ssim);
    iou.add(f.iou);
    row.texture_bytes = std::max(row.texture_bytes, bench.probe->texture_bytes());
    if (i == 0) picture = Picture{kEdge, kEdge, drawn, (*truth)->rgba};
  }
  row.psnr_db = psnr.mean();
  row.ssim = ssim.mean();
  row.iou = iou.mean();
  return row;
}

bool worth_a_picture(const Setting& s) {
  return s.radii == 4 && (s.method != "warp") && !(s.offset_deg >= 10);
}

Result<void> one_model(Context& context, const Model& model, std::vector<Row>& rows) {
  const Result<OpenScene*> scene = open_model(context, model);
  if (!scene) return scene.error();
  SessionRunner& runner = *context.runner;
  TruthSource& truth = *(*scene)->truth;
  truth.set_lighting(field_light(model.light));
  Result<std::unique_ptr<TileProbe>> probe =
      TileProbe::open((*scene)->url, field_light(model.light), runner.renderer());
  if (!probe) return probe.error();
  Result<FrameTarget> target = FrameTarget::create(kEdge, kEdge, 4);
  if (!target) return target.error();
  Bench bench{runner, target.take(), probe.take(), truth};
  // Every n-th of the protocol's 24 directions is used: a tree's truth takes seconds on a CPU.
  const bool slow = model.name != "knot" && model.name != "monkey";
  const int step = !context.options.quick ? 1 : slow ? 12 : 6;
  context.page.heading(fmt::format("{}, {}, {} directions", model.name, model.light,
                                   (kDirections + step - 1) / step));
  for (const Setting& setting : settings(model, context.options.quick)) {
    context.progress.step(fmt::format("{}, {:g} r, {} degrees, {}", model.name, setting.radii,
                                      figure(setting.offset_deg), setting.method));
    std::optional<Picture> picture;
    const Result<Row> row = measure(bench, model, setting, step, picture);
    if (!row) {
      context.omit(kFidelityPart,
                   fmt::format("{}, {:g} r, {}", model.name, setting.radii, setting.method),
                   row.error().line());
      continue;
    }
    rows.push_back(*row);
    if (!picture || !worth_a_picture(setting)) continue;
    const Result<void> shown = context.page.pictures(
        fmt::format("{}, {:g} radii, {} degrees off its capture, {}.", model.name, setting.radii,
                    figure(setting.offset_deg), setting.method),
        *picture);
    if (!shown) return shown;
  }
  truth.forget();
  truth.set_lighting(truth.scene().lighting);
  return {};
}

std::string json_of(const std::vector<Row>& rows) {
  const auto number = [](const std::optional<double>& v) {
    return v && std::isfinite(*v) ? ordered_json(*v) : ordered_json(nullptr);
  };
  ordered_json list = ordered_json::array();
  for (const Row& row : rows) {
    list.push_back({{"model", row.model.name},
                    {"light", row.model.light},
                    {"distance_r", row.setting.radii},
                    {"offset_deg", number(row.setting.offset_deg)},
                    {"method", row.setting.method},
                    {"psnr_db", number(row.psnr_db)},
                    {"ssim", number(row.ssim)},
                    {"iou", number(row.iou)},
                    {"texture_bytes", row.texture_bytes}});
  }
  return ordered_json{{"rows", list}}.dump(1, ' ', false, ordered_json::error_handler_t::replace) +
         "\n";
}

/// Returns the published figures for a row's model and distance; nullptr: there are none.
const Published* published_for(const Row& row) {
  for (const Published& p : kPublished) {
    if (row.model.published && row.model.name == p.model && row.setting.radii == p.radii) return &p;
  }
  return nullptr;
}

void say_found(Page& page, const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    const Published* beside = published_for(row);
    const bool shown = row.setting.method != "fixed8" && row.setting.radii == 4 &&
                       (row.setting.method == "at rest" ||
                        (row.setting.method == "depth" && row.setting.offset_deg == 5 &&
                         row.model.name != "monkey"));
    if (!row.psnr_db || !(shown || beside)) continue;
    const bool lower = beside && *row.psnr_db < beside->psnr_db;
    const std::string what =
        fmt::format("{} at {:g} radii, {} degrees off its capture, {}", row.model.name,
                    row.setting.radii, figure(row.setting.offset_deg), row.setting.method);
    if (shown) {
      page.finding({fmt::format("{:.1f} dB", *row.psnr_db),
                    what + (beside ? fmt::format("; published {:g} dB", beside->psnr_db) : ""),
                    lower});
    }
    if (lower && row.setting.method != "fixed8") {
      page.falls_short(
          fmt::format("{}: {:.1f} dB, published {:g} dB.", what, *row.psnr_db, beside->psnr_db));
    }
  }
}

/// PSNR at 4 radii against the angle off the capture, a panel for each model.
std::vector<Panel> panels_of(const std::vector<Row>& rows) {
  std::vector<Panel> panels;
  for (const Row& row : rows) {
    const std::string title = row.model.name + ", " + row.model.light;
    const bool shown = row.setting.radii == 4 && row.psnr_db && !std::isnan(row.setting.offset_deg);
    if (!shown) continue;
    auto panel = std::find_if(panels.begin(), panels.end(),
                              [&](const Panel& p) { return p.title == title; });
    if (panel == panels.end()) {
      panels.push_back({title, "off the capture, degrees", "PSNR, dB", false, false, {}, {}, {}});
      panel = panels.end() - 1;
    }
    auto series = std::find_if(panel->series.begin(), panel->series.end(),
                               [&](const Series& s) { return s.name == row.setting.method; });
    if (series == panel->series.end()) {
      panel->series.push_back({row.setting.method, {}});
      series = panel->series.end() - 1;
    }
    series->points.emplace_back(row.setting.offset_deg, *row.psnr_db);
  }
  return panels;
}

Table table_of(const std::vector<Row>& rows) {
  Table table({"model", "light", "distance, r", "off the capture, degrees", "drawn as", "PSNR, dB",
               "SSIM", "IoU", "textures, MiB", "published grid", "published PSNR, dB",
               "published SSIM", "published IoU", "published textures, MiB"});
  for (const Row& row : rows) {
    std::vector<std::string> cells = {
        row.model.name,
        row.model.light,
        figure(row.setting.radii),
        figure(row.setting.offset_deg),
        row.setting.method,
        row.psnr_db ? fmt::format("{:.1f}", *row.psnr_db) : "n/a",
        row.ssim ? fmt::format("{:.3f}", *row.ssim) : "n/a",
        row.iou ? fmt::format("{:.3f}", *row.iou) : "n/a",
        fmt::format("{:.2f}", static_cast<double>(row.texture_bytes) / (1 << 20))};
    const Published* beside = published_for(row);
    for (const std::string& cell :
         beside
             ? std::vector<std::string>{beside->grid, figure(beside->psnr_db), figure(beside->ssim),
                                        figure(beside->iou), figure(beside->mib)}
             : std::vector<std::string>(5, "")) {
      cells.push_back(cell);
    }
    table.add(std::move(cells));
  }
  return table;
}

}  // namespace

Result<void> report_fidelity(Context& context) {
  const Result<SessionRunner*> gl = context.graphics();
  if (!gl) return gl.error();
  Page& page = context.page;
  page.section(kFidelityPart, "Fidelity of tiles");
  page.command(context.options.command_line);
  page.method(
      "The field's protocol for octahedral impostors: 512 x 512 pixels, the model's sphere fills "
      "the picture, directions over the upper half of the sphere, grey background. PSNR is taken "
      "over the box around both masks, SSIM in 8 x 8 windows, IoU of the masks (alpha above 127). "
      "lit: ambient 0.6 and a sun of 2.5 from (2,3,1); albedo: ambient only. The tree's blended "
      "leaves are alpha-tested, as the protocol has it.");
  page.method(
      "Tiles come over the wire, by key, one for each object. The truth is the server's full "
      "render "
      "at 4x4 samples. XX, and the picture is refined as it then is. The published figures are "
      "those of "
      "the three.js package octahedral-impostor, whose error is the same whether the eye rests or "
      "not.");
  std::vector<Row> rows;
  const std::vector<Model> todo = models(context);
  std::size_t steps = 0;
  for (const Model& model : todo) steps += settings(model, context.options.quick).size();
  context.progress.begin(kFidelityPart, steps);
  for (const Model& model : todo) {
    if (Result<void> done = one_model(context, model, rows); !done) return done;
  }
  say_found(page, rows);
  context.plot("fidelity", panels_of(rows), 3,
               "PSNR at 4 radii against the angle between the eye and the view of the tile.");
  page.heading("All rows");
  page.table(table_of(rows));
  const Published& large = kPublished[4];
  page.paragraph(
      fmt::format("A published grid of {} views of the knot at {:g} radii reaches {:g} dB in {:g} "
                  "MiB. More views hardly help; perspective and depth do.",
                  large.grid, large.radii, large.psnr_db, large.mib));
  if (const Result<void> done = report_codecs(context); !done) return done;
  return write_file(context.path("fidelity.json"), json_of(rows));
}

}  // namespace mirage
