// Patches: every triangle is in one of them, and what is in view is drawn.
#include "client/hold/patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "client/scene/scene_view.h"
#include "protocol/impostor/camera.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kCells = 64;

/// Returns hills of 64 x 64 m around the origin: an opaque half, a blended half, and a line.
Mesh hills() {
  Mesh out;
  for (std::uint32_t z = 0; z <= kCells; ++z) {
    for (std::uint32_t x = 0; x <= kCells; ++x) {
      const glm::vec2 at = glm::vec2(x, z) - 0.5f * kCells;
      out.vertices.emplace_back().position = {at.x, 3 * std::sin(at.x / 5) * std::cos(at.y / 7),
                                              at.y};
    }
  }
  for (std::uint32_t z = 0; z < kCells; ++z) {
    for (std::uint32_t x = 0; x < kCells; ++x) {
      const std::uint32_t a = z * (kCells + 1) + x, b = a + kCells + 1;
      for (const std::uint32_t i : {a, b, b + 1, a, b + 1, a + 1}) out.indices.push_back(i);
    }
  }
  const auto half = static_cast<std::uint32_t>(out.indices.size() / 2);
  out.indices.insert(out.indices.end(), {0, kCells});
  out.primitives = {{PrimitiveKind::kTriangles, 0, half, 0},
                    {PrimitiveKind::kTriangles, half, half, 1},
                    {PrimitiveKind::kLines, 2 * half, 2, 0}};
  return out;
}

std::vector<Material> materials() {
  std::vector<Material> out(2);
  out[1].alpha_mode = AlphaMode::kBlend;
  return out;
}

std::vector<std::array<std::uint32_t, 3>> triangles(const Mesh& mesh, const Primitive& p) {
  std::vector<std::array<std::uint32_t, 3>> out;
  for (std::uint32_t i = p.first_index; i < p.first_index + p.index_count; i += 3) {
    out.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
  }
  std::sort(out.begin(), out.end());
  return out;
}

TEST(CorePatches, EveryIndexIsInOnePatchAndInItsSphere) {
  const Mesh before = hills();
  Mesh mesh = before;
  const std::vector<Patch> patches = cut_into_patches(mesh, materials());
  ASSERT_EQ(patches.size(), 32 + 1 + 1u);
  std::uint32_t next = 0;
  for (const Patch& patch : patches) {
    ASSERT_EQ(patch.run.first, next);
    next += patch.run.count;
    for (std::uint32_t i = patch.run.first; i < next; ++i) {
      const glm::vec3 at = mesh.vertices[mesh.indices[i]].position;
      ASSERT_LE(glm::distance(at, patch.center), patch.radius);
    }
  }
  EXPECT_EQ(next, mesh.indices.size());
  EXPECT_EQ(triangles(mesh, mesh.primitives[0]), triangles(before, before.primitives[0]));
  const auto blended = static_cast<std::ptrdiff_t>(before.primitives[1].first_index);
  EXPECT_TRUE(std::equal(before.indices.begin() + blended, before.indices.end(),
                         mesh.indices.begin() + blended))
      << "blended triangles and lines keep their order";
}

TEST(CorePatches, PatchesAreSmall) {
  Mesh mesh = hills();
  const std::vector<Patch> patches = cut_into_patches(mesh, materials());
  for (std::size_t i = 0; i < 32; ++i) EXPECT_LT(patches[i].radius, 9) << i;
}

TEST(CorePatches, SmallMeshesStayWhole) {
  Mesh mesh = hills();
  mesh.indices.resize(3 * 4'095);
  mesh.primitives = {{PrimitiveKind::kTriangles, 0, 3 * 4'095, 0}};
  const std::vector<std::uint32_t> before = mesh.indices;
  EXPECT_TRUE(cut_into_patches(mesh, materials()).empty());
  EXPECT_EQ(mesh.indices, before);
}

// The pixel of a refined picture lies up to one pixel beside that of the camera.
TEST(CorePatches, EverythingInViewIsDrawn) {
  Mesh mesh = hills();
  mesh.primitives = {{PrimitiveKind::kTriangles, 0, 6 * kCells * kCells, 0}};
  mesh.indices.resize(mesh.primitives[0].index_count);
  const std::vector<Patch> patches = cut_into_patches(mesh, materials());
  std::mt19937 engine;
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  const auto in_box = [&](double half) {
    return glm::dvec3(uniform(-half, half), uniform(-half, half), uniform(-half, half));
  };
  double drawn_share = 0;
  constexpr int kViews = 200;
  for (int n = 0; n < kViews; ++n) {
    InstanceView instance;
    Similarity& pose = instance.world_from_object;
    pose.position = in_box(1000);
    pose.rotation = glm::angleAxis(static_cast<float>(uniform(0, 6)),
                                   glm::normalize(glm::vec3(1, uniform(-1, 1), uniform(-1, 1))));
    pose.scale = static_cast<float>(uniform(0.1, 10));
    const auto world = [&](const glm::vec3& at) {
      return pose.position + glm::dquat(pose.rotation) * (glm::dvec3(at) * double{pose.scale});
    };
    Camera camera;
    const glm::dvec3 eye = in_box(30);
    camera.pose = look_at(world({eye.x, 4, eye.z}), world(in_box(30)));
    camera.fov_y = uniform(0.2, 1.5);
    std::vector<bool> drawn(mesh.indices.size(), false);
    for (const IndexRun& run : runs_in_view(patches, instance, camera)) {
      std::fill_n(drawn.begin() + static_cast<std::ptrdiff_t>(run.first), run.count, true);
    }
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
      const glm::vec3 at = mesh.vertices[mesh.indices[i]].position;
      const glm::dvec3 pixel = camera.pixel_from_relative(world(at) - camera.pose.eye);
      const bool seen = pixel.z > 0 && pixel.x >= -1 && pixel.x <= camera.width + 1 &&
                        pixel.y >= -1 && pixel.y <= camera.height + 1;
      ASSERT_TRUE(drawn[i] || !seen) << "view " << n;
      drawn_share += drawn[i];
    }
  }
  drawn_share /= kViews * static_cast<double>(mesh.indices.size());
  EXPECT_LT(drawn_share, 0.5) << "what is out of view is left out";
}

TEST(CorePatches, NeighboursInViewShareARun) {
  Mesh mesh = hills();
  const std::vector<Patch> patches = cut_into_patches(mesh, materials());
  Camera camera;
  camera.pose = look_at({0, 500, 0}, {0, 0, 0});
  const std::vector<IndexRun> runs = runs_in_view(patches, {}, camera);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].count, mesh.indices.size());
}

}  // namespace
}  // namespace mirage::test
