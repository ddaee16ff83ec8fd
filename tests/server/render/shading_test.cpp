// Levels of detail look like the whole mesh: normals and colours, seen from all around.
#include <gtest/gtest.h>

#include <cmath>

#include "protocol/impostor/lod.h"
#include "server/lod/lod.h"
#include "server/lod/lod_shading.h"

namespace mirage::test {
namespace {

Mesh indexed(std::vector<Vertex> vertices, std::vector<std::uint32_t> indices) {
  Mesh mesh;
  mesh.vertices = std::move(vertices);
  mesh.indices = std::move(indices);
  mesh.primitives = {
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(mesh.indices.size()), 0}};
  return mesh;
}

// A plate of n x n squares around the z axis. Each triangle has its own vertices, as in files
// without normals. `bumps`: every second square leans, by normals alone.
Mesh plate(std::uint32_t n, float bumps) {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  const auto at = [n](std::uint32_t x, std::uint32_t y) {
    const auto edge = static_cast<float>(n);
    return glm::vec2(static_cast<float>(x) / edge - 0.5f, static_cast<float>(y) / edge - 0.5f);
  };
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const glm::vec2 q[4] = {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)};
      for (const int k : {0, 1, 2, 0, 2, 3}) {
        Vertex v;
        v.position = glm::vec3(q[k], 0);
        v.normal = glm::normalize(glm::vec3((x + y) % 2 ? bumps : -bumps, 0, 1));
        v.uv0 = q[k] + 0.5f;
        indices.push_back(static_cast<std::uint32_t>(vertices.size()));
        vertices.push_back(v);
      }
    }
  }
  return indexed(std::move(vertices), std::move(indices));
}

float size_of(const Mesh& full, const Mesh& level, const std::vector<Material>& materials = {{}},
              const std::vector<Image>& images = {}) {
  const Workers workers(1);
  return MeshShading(full, materials, images, workers).size_of(level);
}

TEST(ServerShading, EqualMeshesAreEqualAtEveryPixel) {
  EXPECT_EQ(size_of(plate(16, 0), plate(16, 0)), 0);
  EXPECT_EQ(size_of(plate(16, 0), plate(3, 0)), 0) << "a plate is one whatever it is cut into";
}

TEST(ServerShading, WhatLeansIsEqualOnlyWhereAPixelHoldsBothWays) {
  const Mesh bumpy = plate(16, 0.5f), flat = plate(1, 0);
  const float size = size_of(bumpy, flat);
  EXPECT_GT(size, 1.0f / 16) << "a pixel of one square shows which way it leans";
  EXPECT_LT(size, 6.0f / 16) << "in larger ones they cancel out";
  Mesh leaning = flat;  // all lean one way: no pixel is large enough
  for (Vertex& v : leaning.vertices) v.normal = glm::normalize(glm::vec3(0.5f, 0, 1));
  EXPECT_GT(size_of(plate(16, 0), leaning), 0.3f);
}

TEST(ServerShading, ColoursCountAsTheyAreDrawn) {
  Material painted;
  painted.base_color_map.image = 0;
  Image image{2, 1, true, {255, 0, 0, 255, 0, 0, 255, 255}};
  const Mesh full = plate(16, 0);
  Mesh slid = full;
  for (Vertex& v : slid.vertices) v.uv0.x += 0.5f;
  EXPECT_EQ(size_of(full, full, {painted}, {image}), 0);
  EXPECT_GT(size_of(full, slid, {painted}, {image}), 0.3f) << "red and blue have changed places";
  EXPECT_EQ(size_of(full, slid), 0) << "without the image nobody sees it";
  painted.base_color_map.offset.x = 0.5f;
  EXPECT_GT(size_of(full, slid, {Material{}}, {}) + 1, size_of(slid, slid, {painted}, {image}));
  for (Vertex& v : slid.vertices) v.color = {65535, 0, 0, 65535};
  EXPECT_GT(size_of(full, slid), 0.3f);
}

// A disk turned on a lathe: flat and with one colour, but its grain is visible.
TEST(ServerShading, TheGrainOfWhatIsBrushedCounts) {
  Mesh full = plate(16, 0), coarse = plate(2, 0);
  for (Mesh* mesh : {&full, &coarse}) {
    for (Vertex& v : mesh->vertices) {
      v.tangent = glm::vec4(glm::normalize(glm::vec3(-v.position.y, v.position.x + 1e-3f, 0)), 1);
    }
  }
  Material brushed;
  brushed.lobes.anisotropy = 0.5f;
  EXPECT_EQ(size_of(full, full, {brushed}), 0);
  EXPECT_GT(size_of(full, coarse, {brushed}), 0.05f) << "between few corners it does not go round";
  EXPECT_EQ(size_of(full, coarse), 0) << "without anisotropy nobody sees it";
}

TEST(ServerShading, NothingToSeeIsEqual) {
  Mesh empty;
  EXPECT_EQ(size_of(empty, empty), 0);
  Mesh lines = plate(1, 0);
  lines.primitives[0].kind = PrimitiveKind::kLines;
  EXPECT_EQ(size_of(lines, lines), 0);
  Mesh broken = plate(16, 0);
  for (Vertex& v : broken.vertices) v.uv0 = glm::vec2(NAN, INFINITY);
  Material painted;
  painted.base_color_map.image = 0;
  const Image image{2, 1, true, {255, 0, 0, 255, 0, 0, 255, 255}};
  EXPECT_EQ(size_of(broken, broken, {painted}, {image}), 0) << "no number is no place to read";
}

// A box on a plate without normals in the file: flat faces, each triangle with its own vertices.
TEST(ServerShading, LevelsOfFlatShadedMeshesStayFlat) {
  Mesh mesh = plate(24, 0);
  const Mesh side = plate(12, 0);
  for (Vertex v : side.vertices) {  // an upright wall on the plate
    v.position = glm::vec3(v.position.x, 0, v.position.y + 0.5f);
    v.normal = glm::vec3(0, -1, 0);
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.vertices.push_back(v);
  }
  mesh.primitives[0].index_count = static_cast<std::uint32_t>(mesh.indices.size());
  const std::vector<MeshLod> lods = build_lods(mesh, {Material{}}, {});
  ASSERT_FALSE(lods.empty());
  for (const MeshLod& lod : lods) {
    for (std::size_t i = 0; i < lod.mesh.indices.size(); i += 3) {
      const Vertex* v[3];
      for (std::size_t k = 0; k < 3; ++k) v[k] = &lod.mesh.vertices[lod.mesh.indices[i + k]];
      const glm::vec3 face =
          glm::cross(v[1]->position - v[0]->position, v[2]->position - v[0]->position);
      if (glm::length(face) < 1e-9f) continue;  // too small to be seen
      for (const Vertex* corner : v) {
        EXPECT_GT(glm::dot(corner->normal, glm::normalize(face)), 0.98f);
      }
    }
    EXPECT_EQ(lod.shading, 0);
  }
}

TEST(ServerShading, AWronglyShadedLevelIsForSmallerPictures) {
  const std::vector<LodInfo> lods = {{900, 9, 0, 0, 0}, {300, 5, 0.001f, 0, 0.05f}};
  EXPECT_EQ(lod_for_view(lods, 1 / 0.06, 1), 1u) << "a pixel is larger than where it shows";
  EXPECT_EQ(lod_for_view(lods, 1 / 0.04, 1), 0u);
  EXPECT_EQ(lod_for_view(lods, 1 / 0.04, 2), 1u) << "tau stretches it like any error";
  EXPECT_EQ(lod_within(lods, kTileErrorTexels * 0.06), 1u);
  EXPECT_EQ(lod_within(lods, kTileErrorTexels * 0.04), 0u);
}

}  // namespace
}  // namespace mirage::test
