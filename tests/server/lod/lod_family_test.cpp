// Levels that uneven copies of one mesh share: their errors hold for every copy.
#include "server/lod/lod_family.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "server/lod/surface_distance.h"
#include "server/prepare/prepared_scene.h"
#include "server/scene/similarity_split.h"

namespace mirage {
namespace {

glm::dmat3 any_shape(std::mt19937& random) {
  std::uniform_real_distribution<double> even(-0.6, 0.6);
  glm::dmat3 out(1);
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) out[c][r] += even(random);
  }
  return out;
}

/// Returns `copies` of a knot, each with a shape of its own.
Scene copies_of_a_knot(std::size_t copies) {
  Scene scene = load_scene("builtin:knot?tubular=64&radial=12").take()->scene;
  const Mesh knot = scene.objects[0].mesh;
  scene.objects.clear();
  std::mt19937 random(5);
  while (scene.objects.size() < copies) {
    const glm::dmat3 shape = any_shape(random);
    if (std::abs(glm::determinant(shape)) < 0.2) continue;
    scene.objects.push_back({"", bake(knot, shape), nullptr, BakedShape{7, shape}});
  }
  return scene;
}

TEST(ServerLodFamily, TheLongestStretchIsNeverLess) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const glm::dmat3 shape = any_shape(random);
    double longest = 0;
    for (int k = 0; k < 2'000; ++k) {
      const glm::dvec3 v(normal(random), normal(random), normal(random));
      longest = std::max(longest, glm::length(shape * v) / glm::length(v));
    }
    EXPECT_GE(longest_stretch(shape), longest);
    EXPECT_LE(longest_stretch(shape), longest * 1.03);
  }
  EXPECT_NEAR(longest_stretch(glm::dmat3(1)), 1, 0.01);
}

TEST(ServerLodFamily, ErrorsHoldForEveryCopy) {
  const Scene scene = copies_of_a_knot(6);
  const LodFamilies families(scene);
  for (const SceneObject& object : scene.objects) {
    ASSERT_EQ(families.first_of(object), &scene.objects[0]);
    const std::vector<MeshLod> lods = families.lods_of(object, Workers());
    ASSERT_GE(lods.size(), 2u);
    for (const MeshLod& lod : lods) {
      const SurfaceTree level(lod.mesh.vertices, lod.mesh.indices);
      double largest = 0;
      for (const Vertex& v : object.mesh.vertices) {
        largest = std::max(largest, level.distance(v.position, 10));
      }
      EXPECT_LE(largest, double{lod.error});
      EXPECT_GT(largest, 0.2 * double{lod.error}) << "no use when it is far above the truth";
      for (const Vertex& v : lod.mesh.vertices) {
        EXPECT_NEAR(glm::length(v.normal), 1, 1e-4);
      }
    }
  }
}

TEST(ServerLodFamily, IsTheSameFromAnyNumberOfThreads) {
  const Scene scene = copies_of_a_knot(6);
  const auto errors = [&](const Workers& workers) {
    const LodFamilies families(scene);
    std::vector<std::vector<MeshLod>> lods(scene.objects.size());
    workers.each(lods.size(),
                 [&](std::size_t i) { lods[i] = families.lods_of(scene.objects[i], workers); });
    std::vector<float> out;
    for (const std::vector<MeshLod>& own : lods) {
      for (const MeshLod& lod : own) {
        out.insert(out.end(), {lod.error, lod.shading, lod.mesh.vertices.back().position.x});
      }
    }
    return out;
  };
  EXPECT_EQ(errors(Workers(4)), errors(Workers()));
}

TEST(ServerLodFamily, FewCopiesFlatOnesAndMovingOnesAreOfNone) {
  const Scene few = copies_of_a_knot(3);
  EXPECT_EQ(LodFamilies(few).first_of(few.objects[0]), nullptr);
  Scene scene = copies_of_a_knot(7);
  scene.objects[1].baked->shape[2] *= 1e-3;
  scene.objects[2].animation = std::make_shared<const Animation>();
  scene.objects[3].baked.reset();
  const LodFamilies families(scene);
  EXPECT_EQ(families.first_of(scene.objects[0]), &scene.objects[0]);
  for (const std::size_t i : {1, 2, 3}) EXPECT_EQ(families.first_of(scene.objects[i]), nullptr);
  EXPECT_EQ(families.first_of(scene.objects[6]), &scene.objects[0]);
}

}  // namespace
}  // namespace mirage
