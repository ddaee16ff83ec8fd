#include "tests/extreme/geometry_vertex_cases.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/draw/frame_target.h"
#include "protocol/base/stable_math.h"
#include "server/render/gpu_scene.h"
#include "server/scene/gltf/gltf_import.h"
#include "tests/extreme/shapes.h"
#include "tests/extreme/studio.h"

namespace mirage::extreme {
namespace {

constexpr float kVertexNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr int kVertexSize = 96;

// G1: an object without any vertex, which no importer would accept, inside the sphere of a ball.
// With and without a part that draws nothing, the ball's pictures and bounds are those without it.
Outcome empty_mesh(const Conditions& conditions) {
  Result<Scene> ball = import_gltf(write(document(dented_ball()), conditions.folder, "ball"));
  if (!ball) return no_studio(ball.error());
  Result<std::unique_ptr<Studio>> alone = Studio::create(*ball);
  if (!alone) return no_studio(alone.error());
  const Camera camera = (*alone)->camera(0, {0.5, 0.4, 1}, 4, kVertexSize);
  const Pixels truth = (*alone)->truth(camera).rgba, mesh = (*alone)->meshes(camera);
  const int draws = (*alone)->draw_calls();
  Checks checks;
  checks.at_least("px of the ball", static_cast<double>(covered(truth)), 1000);
  for (const bool part : {false, true}) {
    Scene scene = *ball;
    SceneObject& nothing = scene.objects.emplace_back();
    if (part) nothing.mesh.primitives.push_back({PrimitiveKind::kTriangles, 0, 0, 0});
    Instance& placed = scene.instances.emplace_back();
    placed.object = static_cast<std::uint32_t>(scene.objects.size() - 1);
    placed.world_from_object.position = {0.3, 0, 0};
    Result<std::unique_ptr<Studio>> both = Studio::create(std::move(scene));
    if (!both) return no_studio(both.error());
    const std::string name = part ? "empty part: " : "no part: ";
    const PreparedScene &a = (*alone)->prepared(), &b = (*both)->prepared();
    checks.holds(name + "bounds of the ball",
                 a.bounds_center == b.bounds_center && a.bounds_radius == b.bounds_radius);
    checks.equal(name + "truth differs by", largest_difference((*both)->truth(camera).rgba, truth),
                 0);
    checks.equal(name + "geometry differs by", largest_difference((*both)->meshes(camera), mesh),
                 0);
    checks.equal(name + "more draws", (*both)->draw_calls() - draws, 0);
    const MadeTile made = (*both)->make_tile((*both)->key_for(camera, 1, kLitTile), 1);
    checks.equal(name + "texels shown", static_cast<double>(covered(made.tile.rgba, 1)), 0);
    checks.equal(name + "tile drawn", (*both)->hold(made, 1) ? 1 : 0, 0);
    checks.equal(name + "header values not finite", not_finite(made.header), 0);
  }
  return checks.outcome();
}

// G2: a thousand points at one place, and triangles whose corners are one point.
Outcome one_point(const Conditions&) {
  Checks checks;
  for (const PrimitiveKind kind : {PrimitiveKind::kPoints, PrimitiveKind::kTriangles}) {
    Scene scene;
    scene.materials.emplace_back();
    SceneObject object;
    object.mesh.vertices.assign(999, Vertex{});
    for (Vertex& v : object.mesh.vertices) v.position = {3, 4, 5};
    for (std::uint32_t i = 0; i < 999; ++i) object.mesh.indices.push_back(i);
    object.mesh.primitives.push_back({kind, 0, 999, 0});
    scene.objects.push_back(object);
    scene.instances.emplace_back();
    Result<std::unique_ptr<Studio>> studio = Studio::create(std::move(scene));
    if (!studio) return no_studio(studio.error());
    const ObjectDescription& told = (*studio)->scene().objects[0];
    const std::string name = kind == PrimitiveKind::kPoints ? "points: " : "triangles: ";
    checks.holds(name + "radius finite and above 0",
                 std::isfinite(told.radius) && told.radius > 0 &&
                     is_finite(glm::dvec3(told.center + told.box_min + told.box_max)));
    Camera camera = (*studio)->camera(0, {0, 0, 1}, 4, kVertexSize);
    const MadeTile made = (*studio)->make_tile((*studio)->key_for(camera, 0, kLitTile), 0);
    checks.equal(name + "header values not finite", not_finite(made.header), 0);
    checks.at_most(name + "px touched",
                   static_cast<double>(covered((*studio)->impostors(camera, DrawMethod::kQuad), 1)),
                   16);
    if (kind == PrimitiveKind::kPoints) {
      checks.at_least(name + "texels touched", static_cast<double>(covered(made.tile.rgba, 1)), 1);
      checks.at_least(name + "px touched in the truth",
                      static_cast<double>(covered((*studio)->truth(camera).rgba, 1)), 1);
    }
  }
  return checks.outcome();
}

// G3: seen in its own plane, exactly and within less than a pixel.
Outcome edge_on(const Conditions& conditions) {
  Shape shape;
  shape.positions = {-1, 0, -1, 1, 0, -0.7f, -0.2f, 0, 1};
  shape.indices = {0, 2, 1};
  test::Builder builder = document(shape);
  set_material(builder, {{"doubleSided", true}});
  Result<std::unique_ptr<Studio>> studio =
      Studio::create(write(builder, conditions.folder, "triangle"));
  if (!studio) return no_studio(studio.error());
  int tallest = 0, bad = 0;
  for (const double lean : {0.0, 1e-12, -1e-7, 1e-5, -1e-4, 1e-3}) {
    for (const glm::dvec3& side : {glm::dvec3(0, 0, 1), glm::dvec3(0.6, 0, 0.8)}) {
      const Camera camera = (*studio)->camera(0, side + glm::dvec3(0, lean, 0), 4, kVertexSize);
      const MadeTile made = (*studio)->make_tile((*studio)->key_for(camera, 0, kLitTile), 0);
      bad += not_finite(made.header);
      // Rows with any opaque content, in texels.
      std::vector<bool> rows(made.tile.crop.h, false);
      for (std::size_t i = 0; i < made.tile.crop.area(); ++i) {
        if (made.tile.rgba[i * 4 + 3] >= 128) rows[i / made.tile.crop.w] = true;
      }
      tallest = std::max(tallest, static_cast<int>(std::count(rows.begin(), rows.end(), true)));
      const Pixels drawn = (*studio)->impostors(camera, DrawMethod::kDepth);
      int height = 0;
      for (int y = 0; y < kVertexSize; ++y) {
        bool any = false;
        for (int x = 0; x < kVertexSize; ++x) {
          any = any || drawn[static_cast<std::size_t>((y * kVertexSize + x) * 4 + 3)] >= 128;
        }
        height += any ? 1 : 0;
      }
      tallest = std::max(tallest, height);
    }
  }
  Checks checks;
  checks.equal("header values not finite", bad, 0);
  checks.at_most("rows covered", tallest, 1);
  return checks.outcome();
}

// G4: two impossible vertices among many.
Outcome one_bad_vertex(const Conditions& conditions) {
  const int side = conditions.quick ? 316 : 1000;
  Shape shape = dented_ball(side - 1, side - 1);
  const std::size_t a = static_cast<std::size_t>(side) * 100 + 50, b = a + 7;
  std::size_t touched = 0;
  for (std::size_t i = 0; i < shape.indices.size(); i += 3) {
    bool touches = false;
    for (int c = 0; c < 3; ++c) {
      touches = touches || shape.indices[i + c] == a || shape.indices[i + c] == b;
    }
    touched += touches ? 1 : 0;
  }
  glm::vec3 low(kInf), high(-kInf);
  for (std::size_t v = 0; v < shape.vertices(); ++v) {
    const glm::vec3 p(shape.positions[v * 3], shape.positions[v * 3 + 1],
                      shape.positions[v * 3 + 2]);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  shape.positions[a * 3 + 1] = kVertexNan;
  shape.positions[b * 3] = -kInf;
  const Result<Scene> scene = import_gltf(write(document(shape), conditions.folder, "bad"));
  if (!scene) return no_studio(scene.error());
  const SceneObject& object = scene->objects[0];
  const ObjectDescription told = describe_object(object, *scene);
  Checks checks;
  checks.equal("triangles dropped",
               static_cast<double>(shape.indices.size() - object.mesh.indices.size()) / 3,
               static_cast<double>(touched));
  double counted = 0;
  for (const std::string& warning : scene->warnings) {
    if (warning.find("not finite") != std::string::npos) counted = std::atof(warning.c_str());
  }
  checks.equal("told to the user", counted, static_cast<double>(touched));
  checks.at_most("box off by", glm::length(told.box_min - low) + glm::length(told.box_max - high),
                 0);
  return checks.outcome();
}

}  // namespace

std::vector<Case> geometry_vertex_cases() {
  return {
      {"G1", "object without a vertex", "alpha 0, no draw", empty_mesh},
      {"G2", "all vertices equal, as points and as triangles", "finite", one_point},
      {"G3", "triangle edge-on, exactly and nearly", "<= 1 px, no NaN", edge_on},
      {"G4", "a NaN and an infinite vertex among 1e6", "dropped, counted, box of the rest",
       one_bad_vertex},
  };
}

}  // namespace mirage::extreme
