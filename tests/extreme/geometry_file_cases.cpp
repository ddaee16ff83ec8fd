#include "tests/extreme/geometry_file_cases.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include "client/draw/frame_target.h"
#include "client/plan/tile_fit.h"
#include "client/plan/tile_need.h"
#include "protocol/base/stable_math.h"
#include "protocol/impostor/error_bound.h"
#include "server/render/gpu_scene.h"
#include "server/scene/gltf/gltf_import.h"
#include "tests/extreme/shapes.h"
#include "tests/extreme/studio.h"

namespace mirage::extreme {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kFileSize = 96;
using nlohmann::json;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

// G11: flattened to a plane, to a line, to a point, and a projection onto an oblique plane.
Outcome singular(const Conditions& conditions) {
  Checks checks;
  struct Try {
    const char* name;
    json node;
    bool shows;       ///< seen from straight above
    glm::vec3 plane;  ///< normal of the plane that everything falls into; 0: none
  };
  // Columns: everything falls into the plane x + y + z = 0.
  const json oblique = {2, -1, -1, 0, -1, 2, -1, 0, -1, -1, 2, 0, 0, 0, 0, 1};
  const Try tries[] = {{"plane", {{"scale", {1, 0, 1}}}, true, {0, 1, 0}},
                       {"line", {{"scale", {1, 0, 0}}}, false, {}},
                       {"point", {{"scale", {0, 0, 0}}}, false, {}},
                       {"oblique", {{"matrix", oblique}}, true, glm::normalize(glm::vec3(1))}};
  for (const Try& one : tries) {
    test::Builder builder = document(dented_ball());
    set_material(builder, {{"doubleSided", true}});
    builder.doc["nodes"][0].update(one.node);
    Result<std::unique_ptr<Studio>> studio =
        Studio::create(write(builder, conditions.folder, one.name));
    if (!studio) return no_studio(studio.error());
    const std::string name = std::string(one.name) + ": ";
    int bad = 0, leaning = 0;
    std::size_t pixels = 0;
    for (std::uint32_t i = 0; i < (*studio)->scene().instances.size(); ++i) {
      const Camera camera = (*studio)->camera(i, {0.3, 1, 0.2}, 4, kFileSize);
      bad += not_finite((*studio)->make_tile((*studio)->key_for(camera, i, kLitTile), i).header);
      pixels = covered((*studio)->truth(camera).rgba);
      for (const Vertex& v : (*studio)->prepared().scene.objects[0].mesh.vertices) {
        bad += std::abs(glm::length(v.normal) - 1) < 1e-5f ? 0 : 1;
        leaning += std::abs(glm::dot(v.normal, one.plane)) > 1 - 1e-5f ? 0 : 1;
      }
    }
    checks.equal(name + "values not finite or unit", bad, 0);
    if (!one.shows) continue;
    checks.at_least(name + "covered px", static_cast<double>(pixels), 500);
    checks.equal(name + "normals off the plane's", leaning, 0);
  }
  return checks.outcome();
}

// G12: a cube whose normals are 0 or NaN, against the same with its faces' normals.
Outcome no_normals(const Conditions& conditions) {
  const Shape good = box({-1, -0.8, -0.6}, {0.7, 0.9, 1});
  Shape bad = good;
  for (std::size_t i = 0; i < bad.normals.size(); ++i) bad.normals[i] = i / 3 % 2 ? kNan : 0.0f;
  Result<std::unique_ptr<Studio>> a = Studio::create(write(document(good), conditions.folder, "a"));
  Result<std::unique_ptr<Studio>> b = Studio::create(write(document(bad), conditions.folder, "b"));
  if (!a || !b) return no_studio((a ? b : a).error());
  double off = 0;
  const auto& va = (*a)->prepared().scene.objects[0].mesh.vertices;
  const auto& vb = (*b)->prepared().scene.objects[0].mesh.vertices;
  for (std::size_t i = 0; i < std::min(va.size(), vb.size()); ++i) {
    off = std::max(off, double{glm::length(va[i].normal - vb[i].normal)});
  }
  const Camera camera = (*a)->camera(0, {1, 0.8, 0.6}, 4, kFileSize);
  Checks checks;
  checks.equal("vertices", static_cast<double>(vb.size()), static_cast<double>(va.size()));
  checks.at_most("normals off by", std::isfinite(off) ? off : 9, 1e-6);
  checks.equal("images differ by",
               largest_difference((*a)->truth(camera).rgba, (*b)->truth(camera).rgba), 0);
  return checks.outcome();
}

/// Returns nodes, each below the former. The last has the box and, if given, a child further up.
test::Builder chain(std::size_t nodes, std::optional<std::size_t> child = std::nullopt) {
  test::Builder builder = document(box({0, 0, 0}, {1, 1, 1}));
  json& list = builder.doc["nodes"];
  const json leaf = list[0];
  list = json::array();
  for (std::size_t i = 0; i + 1 < nodes; ++i) {
    list.push_back({{"children", {i + 1}}, {"translation", {0.25, 0, 0}}});
  }
  list.push_back(leaf);
  if (child) list.back()["children"] = {*child};
  return builder;
}

// G13
Outcome deep_nodes(const Conditions& conditions) {
  constexpr std::size_t kDeep = 100'000;
  Checks checks;
  const double start = seconds_now();
  const Result<Scene> deep = import_gltf(write(chain(kDeep), conditions.folder, "deep"));
  if (!deep) return no_studio(deep.error());
  checks.equal("leaf at x", deep->instances.at(0).world_from_object.position.x, 0.25 * (kDeep - 1));
  checks.at_most("seconds", seconds_now() - start, 20);
  // All nodes on one loop; a loop of three beside a node on none; a loop that is entered from
  // outside; a node that is its own child. The last two can be drawn: each node stays where it is
  // listed first.
  test::Builder beside = chain(3, 0);
  beside.doc["nodes"].push_back({{"name", "beside"}});
  test::Builder self = document(box({0, 0, 0}, {1, 1, 1}));
  self.doc["nodes"][0]["children"] = {0};
  struct Loop {
    test::Builder builder;
    const char* path;
    bool drawn;
  };
  const Loop loops[] = {{chain(kDeep, 0), "a node lies below itself: ... > nodes[", false},
                        {std::move(beside), "nodes[0] > nodes[1]", false},
                        {chain(kDeep, kDeep / 2),
                         "nodes[50000] has two parents, nodes[49999] and nodes[99999]", true},
                        {std::move(self), "nodes[0] is its own child", true}};
  for (const Loop& loop : loops) {
    const std::string file = write(loop.builder, conditions.folder, "loop");
    const Result<Scene> strict = import_gltf(file, Workers(), {.strict = true});
    checks.holds("loop refused as such", !strict && strict.error().id == ErrorId::kSceneCycle);
    const std::string text = strict ? "" : strict.error().text;
    if (text.find(loop.path) == std::string::npos) checks.failed("path told: " + text);
    const Result<Scene> forgiven = import_gltf(file);
    checks.equal("instances drawn", forgiven ? static_cast<double>(forgiven->instances.size()) : 0,
                 loop.drawn ? 1 : 0);
  }
  return checks.outcome();
}

// G14: nothing out of range reaches the device, and nothing is allocated for counts without data.
Outcome counts(const Conditions& conditions) {
  Checks checks;
  Shape shape = dented_ball();
  const auto last = static_cast<std::uint32_t>(shape.vertices());
  for (const std::uint32_t index : {last, last + 1, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
    shape.indices.insert(shape.indices.end(), {0, 1, index});
  }
  Result<std::unique_ptr<Studio>> studio =
      Studio::create(write(document(shape), conditions.folder, "indices"));
  if (!studio) return no_studio(studio.error());
  const Mesh& mesh = (*studio)->prepared().scene.objects[0].mesh;
  int beyond = 0;
  for (const std::uint32_t i : mesh.indices) beyond += i < mesh.vertices.size() ? 0 : 1;
  checks.equal("indices out of range uploaded", beyond, 0);
  checks.equal("triangles kept", static_cast<double>(mesh.indices.size()) / 3,
               static_cast<double>(shape.indices.size()) / 3 - 5);
  double counted = 0;
  for (const std::string& warning : (*studio)->prepared().scene.warnings) {
    if (warning.find("beyond the vertices") != std::string::npos) {
      counted = std::atof(warning.c_str());
    }
  }
  checks.equal("told to the user", counted, 5);
  const double before = peak_mb();
  int loaded = 0, flat = 0, tried = 0;
  for (const double count :
       {3e5, 65536.0 * 65536, 2147483647.0, 2147483648.0, 4294967295.0, 9e15}) {
    for (const char* what : {"accessors", "bufferViews"}) {
      for (const int index : {0, 1, 2}) {  // positions, normals, indices
        test::Builder builder = document(dented_ball());
        const char* field = std::string(what) == "accessors" ? "count" : "byteLength";
        builder.doc[what][static_cast<std::size_t>(index)][field] =
            static_cast<std::uint64_t>(count);
        const std::string file = write(builder, conditions.folder, "count");
        loaded += import_gltf(file, Workers(), {.strict = true}).ok() ? 1 : 0;
        const Result<Scene> rest = import_gltf(file);  // normals cost themselves alone
        flat += rest.ok() && index == 1 && !rest->warnings.empty() ? 1 : 0;
        loaded += rest.ok() && index != 1 ? 1 : 0;
        ++tried;
      }
    }
  }
  checks.equal("impossible counts accepted of " + std::to_string(tried), loaded, 0);
  checks.equal("drawn with flat faces in their place", flat, tried / 3);
  checks.at_most("MB allocated for them", peak_mb() - before, 64);
  return checks.outcome();
}

// G15: forty copies of a ball of 250,000 triangles at one place, all within a pixel.
Outcome crowded(const Conditions& conditions) {
  const int rings = conditions.quick ? 100 : 500, copies = 40;
  test::Builder builder = document(dented_ball(rings, 250));
  const json leaf = builder.doc["nodes"][0];
  for (int i = 1; i < copies; ++i) builder.doc["nodes"].push_back(leaf);
  Result<std::unique_ptr<Studio>> studio =
      Studio::create(write(builder, conditions.folder, "crowd"));
  if (!studio) return no_studio(studio.error());
  Camera camera = (*studio)->camera(0, {0.5, 0.4, 1}, 50, 16, 10);  // about a pixel and a half
  const double start = seconds_now();
  const ReferenceFrame truth = (*studio)->truth(camera, 1);
  const double truth_s = seconds_now() - start;
  const DrawList list = (*studio)->impostor_list(camera, DrawMethod::kDepth);
  Pixels drawn = (*studio)->draw(camera, list);
  const auto time_of = [&](const DrawList& l) {
    double best = 1e9;
    for (int i = 0; i < 5; ++i) {
      const double at = seconds_now();
      drawn = (*studio)->draw(camera, l);
      best = std::min(best, seconds_now() - at);
    }
    return best;
  };
  DrawList one;
  one.impostors = {list.impostors.at(0)};
  const double all_s = time_of(list), one_s = time_of(one);
  std::size_t any = 0, any_truth = 0;
  for (std::size_t i = 3; i < drawn.size(); i += 4) {
    any += drawn[i] > 0 ? 1 : 0;
    any_truth += truth.rgba[i] > 0 ? 1 : 0;
  }
  Checks checks;
  const double triangles =
      static_cast<double>(copies) * static_cast<double>((*studio)->prepared().objects[0].triangles);
  checks.at_least("triangles", triangles, conditions.quick ? 1.9e6 : 0.99e7);
  checks.at_least("px covered in the truth", static_cast<double>(any_truth), 1);
  checks.at_least("px covered by impostors", static_cast<double>(any), 1);
  checks.at_most("px covered by impostors", static_cast<double>(any), 12);
  checks.at_most("seconds for the truth", truth_s, 100);
  checks.at_most("frame, times one impostor's", all_s / one_s, 10);
  return checks.outcome();
}

// Returns the ratio of the singular values of the map from texels to pixels.
double anisotropy(const Capture& capture, const Camera& camera, const glm::dvec2& texel, double z) {
  const auto pixel = [&](const glm::dvec2& t) {
    return glm::dvec2(camera.pixel_from_relative(capture.point_from_texel(t, z) - camera.pose.eye));
  };
  const glm::dvec2 a = pixel(texel + glm::dvec2(0.5, 0)) - pixel(texel - glm::dvec2(0.5, 0));
  const glm::dvec2 b = pixel(texel + glm::dvec2(0, 0.5)) - pixel(texel - glm::dvec2(0, 0.5));
  const double sum = glm::dot(a, a) + glm::dot(b, b);
  const double det = std::abs(a.x * b.y - a.y * b.x);
  const double root = std::sqrt(std::max(sum * sum - 4 * det * det, 0.0));
  return std::sqrt((sum + root) / std::max(sum - root, 1e-300));
}

// G16: a blade a million times as long as it is thick, and a hundred times as wide as high.
Outcome needle(const Conditions& conditions) {
  const double thin = 1e-6;
  Result<std::unique_ptr<Studio>> studio = Studio::create(
      write(document(box({-1, -0.01, -thin}, {1, 0.01, thin})), conditions.folder, "needle"));
  if (!studio) return no_studio(studio.error());
  Random random(conditions.seed);
  Checks checks;
  const Camera level = (*studio)->camera(0, {0, 0.2, 1}, 6, 256);
  const MadeTile made = (*studio)->make_tile((*studio)->key_for(level, 0, kLitTile), 0);
  const double edge = made.capture.edge;
  checks.at_least("texels", static_cast<double>(covered(made.tile.rgba, 1)), 50);
  checks.at_most("crop, share of the window",
                 static_cast<double>(made.tile.crop.area()) / (edge * edge), 0.05);
  checks.equal("header values not finite", not_finite(made.header), 0);
  double worst = 1;
  int drawn = 0;
  for (int i = 0; i < conditions.count(2000); ++i) {
    // Views from all sides; the tile of each view is seen from beside it, as far as the bound
    // allows.
    const double radii = random.log_uniform(2, 100);
    const Camera at = (*studio)->camera(0, random.direction(), radii, 256);
    const TileKey key = (*studio)->key_for(at, 0, kLitTile);
    const Capture capture(key.cell, key.distance, (*studio)->scene().objects[0].radius,
                          tile_edge(key.size_class));
    Camera seen = at;
    const glm::dvec3 off =
        random.direction() * (glm::length(at.pose.eye) * random.log_uniform(1e-4, 1));
    seen.pose = look_at(at.pose.eye + off, {0, 0, 0});
    const ViewGeometry view =
        view_geometry(seen, (*studio)->scene().instances[0], (*studio)->scene().objects[0]);
    const DrawnDepth flat{view.radius, view.radius, 0, 0, 0, 0};
    if (is_stale(position_bound_px(view, capture.geometry(), flat), 1.0)) continue;
    ++drawn;
    for (const double x : {0.0, edge}) {
      for (const double y : {0.0, edge}) {
        worst = std::max(worst, anisotropy(capture, seen, {x, y}, capture.distance));
      }
    }
  }
  checks.at_least("views within tau", drawn, conditions.quick ? 20 : 200);
  checks.at_most("anisotropy", worst, 2);
  return checks.outcome();
}

}  // namespace

std::vector<Case> geometry_file_cases() {
  return {
      {"G11", "singular transforms: a plane, a line, a point, an oblique plane",
       "finite, unit normals, still drawn", singular},
      {"G12", "normals zero and NaN", "face normals", no_normals},
      {"G13", "node chain 1e5 deep; cycle", "loaded in place; refused with the path", deep_nodes},
      {"G14", "index out of range; counts to 2^32 - 1", "refused before upload", counts},
      {"G15", "1e7 triangles in a pixel", "drawn, client frame <= 10 times one impostor's", crowded,
       240, 4096, true},
      {"G16", "needle 1e6 : 1", "cropped, anisotropy <= 2", needle},
  };
}

}  // namespace mirage::extreme
