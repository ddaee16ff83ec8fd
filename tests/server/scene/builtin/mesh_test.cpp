// Every mesh of every built-in scene is sound.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "server/scene/builtin/builtin_scene.h"
#include "server/scene/builtin/mesh_builder.h"

namespace mirage {
namespace {

struct Defects {
  int bad_index = 0;
  int degenerate = 0;
  int not_finite = 0;
  int bad_normal = 0;
  int bad_tangent = 0;
  int bad_material = 0;
};

Defects find_defects(const Mesh& mesh, std::size_t materials) {
  Defects d;
  for (const Vertex& v : mesh.vertices) {
    const float sum = glm::dot(v.position, v.position) + v.uv0.x + v.uv0.y + v.uv1.x + v.uv1.y;
    d.not_finite += !std::isfinite(sum);
    const glm::vec3 t(v.tangent);
    d.bad_normal += !(std::abs(glm::length(v.normal) - 1) < 1e-4f);
    d.bad_tangent += !(std::abs(glm::length(t) - 1) < 1e-4f) ||
                     !(std::abs(glm::dot(t, v.normal)) < 1e-4f) || std::abs(v.tangent.w) != 1;
  }
  std::size_t covered = 0;
  for (const Primitive& p : mesh.primitives) {
    d.bad_material += p.material >= materials;
    d.bad_index += p.first_index != covered || p.index_count % 3 != 0;
    covered += p.index_count;
  }
  d.bad_index += covered != mesh.indices.size();
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::array<glm::vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      if (mesh.indices[i + k] >= mesh.vertices.size()) {
        ++d.bad_index;
        return d;
      }
      p[k] = mesh.vertices[mesh.indices[i + k]].position;
    }
    const glm::dvec3 n =
        glm::cross(glm::dvec3(p[1]) - glm::dvec3(p[0]), glm::dvec3(p[2]) - glm::dvec3(p[0]));
    d.degenerate += !(glm::length(n) > 1e-10);
  }
  return d;
}

class BuiltinMesh : public testing::TestWithParam<const char*> {};

TEST_P(BuiltinMesh, IsSound) {
  const auto built = build_builtin_scene(GetParam());
  ASSERT_TRUE(built.ok());
  const Scene& scene = *built;
  for (const Material& m : scene.materials) {
    EXPECT_LT(m.base_color_map.image, static_cast<int>(scene.images.size()));
  }
  for (const Image& image : scene.images) {
    EXPECT_EQ(image.rgba.size(), std::size_t{4} * image.width * image.height);
  }
  for (const SceneObject& object : scene.objects) {
    const Defects d = find_defects(object.mesh, scene.materials.size());
    EXPECT_GT(object.mesh.indices.size(), 0u) << object.name;
    EXPECT_EQ(d.bad_index, 0) << object.name;
    EXPECT_EQ(d.degenerate, 0) << object.name;
    EXPECT_EQ(d.not_finite, 0) << object.name;
    EXPECT_EQ(d.bad_normal, 0) << object.name;
    EXPECT_EQ(d.bad_tangent, 0) << object.name;
    EXPECT_EQ(d.bad_material, 0) << object.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, BuiltinMesh,
                         testing::Values("forest?trees=20&species=8", "clutter", "city?blocks=2",
                                         "museum?objects=12&triangles=5000&seed=4", "knot",
                                         "knot?R=0.5&r=0.1&tubular=7&radial=3&p=3&q=2",
                                         "field?instances=10"));

/// Six times the enclosed volume: positive when a closed mesh is wound outward.
double winding_volume(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 a = mesh.vertices[mesh.indices[i]].position;
    const glm::dvec3 b = mesh.vertices[mesh.indices[i + 1]].position;
    const glm::dvec3 c = mesh.vertices[mesh.indices[i + 2]].position;
    sum += glm::dot(a, glm::cross(b, c));
  }
  return sum;
}

TEST(BuiltinMeshBuilder, SolidsAreClosedAndWoundOutward) {
  using builtin::MeshBuilder;
  MeshBuilder b;
  b.box({-1, -1, -1}, {1, 1, 1});
  EXPECT_NEAR(winding_volume(b.take()), 6 * 8, 1e-4);
  b.rounded_box({-1, -1, -1}, {1, 1, 1}, 0.1f, 4);
  EXPECT_NEAR(winding_volume(b.take()), 6 * 7.95, 0.2);
  b.sphere({3, 1, 2}, {1, 2, 1}, 32, 64);
  EXPECT_NEAR(winding_volume(b.take()), 6 * 8.378, 0.3);
  b.cylinder({0, 1, 0}, 1, 2, 64);
  EXPECT_NEAR(winding_volume(b.take()), 6 * 6.283, 0.1);
  b.rod({0, 0, 0}, {2, 1, 1}, 0.5f, 64);
  EXPECT_NEAR(winding_volume(b.take()), 6 * 1.924, 0.1);
}

TEST(BuiltinKnot, FollowsTheFormula) {
  const auto built = build_builtin_scene("knot");
  ASSERT_TRUE(built.ok());
  const Mesh& mesh = built->objects[0].mesh;
  ASSERT_EQ(mesh.vertices.size(), 201u * 33u);
  ASSERT_EQ(mesh.indices.size(), 200u * 32u * 6u);
  // Place (i, j) = (0, 0): P1 = (1.5, 0, 0), and the first ring's offset is -N * tube.
  const auto curve = [](double u) {
    const double over = 1.5 * u;
    return glm::dvec3((2 + std::cos(over)) * 0.5 * std::cos(u),
                      (2 + std::cos(over)) * 0.5 * std::sin(u), 0.5 * std::sin(over));
  };
  for (const auto& [i, j] : {std::pair{0, 0}, {0, 8}, {50, 16}, {133, 5}, {200, 32}}) {
    const double u = i / 200.0 * 2 * 6.283185307179586;
    const double v = j / 32.0 * 6.283185307179586;
    const glm::dvec3 p1 = curve(u);
    const glm::dvec3 p2 = curve(u + 0.01);
    const glm::dvec3 b = glm::cross(p2 - p1, p2 + p1);
    const glm::dvec3 n = glm::normalize(glm::cross(b, p2 - p1));
    const glm::dvec3 want = p1 - 0.35 * std::cos(v) * n + 0.35 * std::sin(v) * glm::normalize(b);
    const Vertex& got = mesh.vertices[static_cast<std::size_t>(i * 33 + j)];
    EXPECT_LT(glm::length(glm::dvec3(got.position) - want), 1e-6) << i << " " << j;
    EXPECT_LT(glm::length(glm::dvec3(got.normal) - (want - p1) / 0.35), 1e-5) << i << " " << j;
  }
  EXPECT_GT(winding_volume(mesh), 0);
}

}  // namespace
}  // namespace mirage
