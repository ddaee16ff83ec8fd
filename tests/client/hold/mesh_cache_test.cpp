// Mesh cache: levels by screen-space error, coarse ones first, and what is dropped within the
// budget.
#include "client/hold/mesh_cache.h"

#include <gtest/gtest.h>

#include "client/plan/mesh_wants.h"
#include "client/plan/selector_input.h"
#include "protocol/codec/model_codec.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

ObjectModel triangles_of(std::uint32_t count, std::int32_t image = -1, bool mask = false) {
  ObjectModel model;
  model.mesh.vertices.resize(std::size_t{count} * 3);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      Vertex& v = model.mesh.vertices[i * 3 + k];
      v.position = {k == 1, k == 2, 0};
      v.uv0 = glm::vec2(v.position) * 0.5f;  // half a texture for a unit
      model.mesh.indices.push_back(i * 3 + k);
    }
  }
  model.mesh.primitives = {{PrimitiveKind::kTriangles, 0, count * 3, 0}};
  model.materials.resize(1);
  model.materials[0].base_color_map.image = image;
  if (mask) model.materials[0].alpha_mode = AlphaMode::kMask;
  return model;
}

struct World {
  explicit World(std::size_t budget = 64u << 20, std::uint32_t objects = 1) {
    SceneOptions options;
    options.objects = objects;
    options.geometry = true;
    std::vector<Placed> placed;
    for (std::uint32_t i = 0; i < objects; ++i) placed.push_back({{0, 0, 0}, 1, i});
    scene = make_scene(placed, options);
    for (ObjectDescription& object : scene.objects) {
      object.box_min = glm::vec3(-1);  // no closer to the eye than the sphere
      object.box_max = glm::vec3(1);
      object.lods = {{9000, 90'000, 0.0f, 0}, {3000, 30'000, 0.002f, 0}, {1000, 10'000, 0.02f, 0}};
    }
    scene.images = {{2048, 1024, true, {}, 0}, {64, 64, true, {}, 0.5f}};
    cache.reset(scene, budget, 1 << 20);
    camera.width = 640;
    camera.height = 360;
  }
  void look_from(double distance) { camera.pose = look_at({0, 0, distance}, {0, 0, 0}); }
  std::vector<AssetNeed> needs(std::int64_t now_us = 0) {
    MeshWants all;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
      all.instances.push_back(i);
      all.gain[scene.instances[i].object] += 1;
    }
    SelectorInput in;
    in.scene = &scene;
    in.predicted = camera;
    return cache.needs(scene, 1, now_us, mesh_wants(in, all));
  }
  std::uint8_t drawn_lod(std::uint64_t frame = 1, std::int64_t now_us = 0) {
    std::vector<DrawnMesh> meshes{{0}};
    cache.choose(scene, camera, 1, frame, now_us, meshes);
    return meshes[0].lod;
  }
  void add(std::uint8_t lod, std::int64_t now_us = 0, std::uint32_t object = 0) {
    cache.add_mesh(object, lod, triangles_of(scene.objects[object].lods[lod].triangles), now_us);
  }
  SceneView scene;
  MeshCache cache;
  Camera camera;
};

TEST(CoreMeshCache, LevelByScreenSpaceError) {
  World world;
  for (std::uint8_t lod = 0; lod < 3; ++lod) world.add(lod);
  const double f = world.camera.focal_px();
  // f * error / (distance - radius) <= 1
  for (const auto& [distance, lod] :
       {std::pair(1 + 0.02 * f * 1.01, 2), std::pair(1 + 0.02 * f * 0.99, 1),
        std::pair(1 + 0.002 * f * 1.01, 1), std::pair(1 + 0.002 * f * 0.99, 0)}) {
    world.look_from(distance);
    EXPECT_EQ(world.drawn_lod(), lod) << distance;
  }
}

TEST(CoreMeshCache, SceneryMayBeTwiceAsCoarseAndWhatIsImportantHalf) {
  World world;
  for (std::uint8_t lod = 0; lod < 3; ++lod) world.add(lod);
  world.look_from(1 + 0.02 * world.camera.focal_px() * 0.99);
  EXPECT_EQ(world.drawn_lod(), 1);
  world.scene.instances[0].importance = Importance::kScenery;
  EXPECT_EQ(world.drawn_lod(), 2);
  world.look_from(1 + 0.002 * world.camera.focal_px() * 1.5);
  world.scene.instances[0].importance = Importance::kNormal;
  EXPECT_EQ(world.drawn_lod(), 1);
  world.scene.instances[0].importance = Importance::kImportant;
  EXPECT_EQ(world.drawn_lod(), 0);
}

TEST(CoreMeshCache, ThinnedFoliageMayMoveFurther) {
  const std::vector<LodInfo> lods = {{9, 9, 0, 0}, {3, 3, 0, 0.1f}};
  EXPECT_EQ(lod_for_view(lods, 0.99 * kSpreadPerTau / 0.1, 1), 1u);
  EXPECT_EQ(lod_for_view(lods, 1.01 * kSpreadPerTau / 0.1, 1), 0u);
}

TEST(CoreMeshCache, CoarseFirstThenWhatIsNeeded) {
  World world;
  world.look_from(1.5);  // needs the whole mesh
  EXPECT_FALSE(world.cache.ready()[0]);
  std::vector<AssetNeed> needs = world.needs();
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_EQ(needs[0].id.level, 2) << "something quick";
  EXPECT_NEAR(needs[0].expected_bytes, 10'000, 100);
  world.add(2);
  EXPECT_TRUE(world.cache.ready()[0]);
  EXPECT_EQ(world.drawn_lod(), 2) << "the best that is there";
  needs = world.needs();
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_EQ(needs[0].id.level, 0);
  world.add(0);
  EXPECT_EQ(world.drawn_lod(), 0);
  EXPECT_TRUE(world.needs().empty());
}

TEST(CoreMeshCache, FinerThanNeededIsDrawnAndNothingAsked) {
  World world;
  world.add(0);
  world.look_from(200);
  EXPECT_EQ(world.drawn_lod(), 0);
  EXPECT_TRUE(world.needs().empty());
}

TEST(CoreMeshCache, DropsWhatIsNotNeededForAWhile) {
  World world;
  world.look_from(1.5);
  world.add(2);
  world.add(0);
  std::uint64_t frame = 1;
  for (std::int64_t t = 0; t <= 11 * kSecond; t += kSecond) {
    world.needs(t);
    EXPECT_EQ(world.drawn_lod(++frame, t), 0);
    const std::vector<AssetId> gone = world.cache.drop(frame, t);
    EXPECT_EQ(gone.size(), t == 11 * kSecond ? 1u : 0u) << t;
    for (const AssetId& id : gone) EXPECT_EQ(id.level, 2) << "the one in use stays";
  }
  const std::size_t before = world.cache.bytes();
  EXPECT_GT(before, 0u);
  EXPECT_EQ(world.cache.drop(frame + 1, 22 * kSecond).size(), 1u);
  EXPECT_EQ(world.cache.bytes(), 0u);
  EXPECT_FALSE(world.cache.ready()[0]);
}

TEST(CoreMeshCache, BudgetTakesTheOldestButNeverWhatIsDrawn) {
  const std::size_t one = std::size_t{9000} * 3 * (sizeof(Vertex) + 4);
  World world(2 * one + 1000, 3);
  world.look_from(1.5);
  for (std::uint32_t i = 0; i < 3; ++i) world.add(0, i, i);  // 0 is the oldest
  std::vector<DrawnMesh> meshes{{0}};
  world.cache.choose(world.scene, world.camera, 1, 7, 0, meshes);  // 0 stays the oldest
  const std::vector<AssetId> gone = world.cache.drop(7, 4);
  ASSERT_EQ(gone.size(), 1u);
  EXPECT_EQ(gone[0].index, 1u) << "the oldest that is not drawn in this frame";
  EXPECT_TRUE(world.cache.ready()[0]);
  EXPECT_EQ(world.cache.bytes(), 2 * one);
}

TEST(CoreMeshCache, WhatDoesNotFitIsNotAskedFor) {
  World world(std::size_t{4000} * (12 + 45));  // the second level fits, the first does not
  world.look_from(1.5);
  world.add(2);
  const std::vector<AssetNeed> needs = world.needs();
  ASSERT_EQ(needs.size(), 0u) << "level 2 is in use and fills it";
  World roomier(std::size_t{4000} * (12 + 45));
  roomier.look_from(1.5);
  const std::vector<AssetNeed> first = roomier.needs();
  ASSERT_EQ(first.size(), 1u);
  EXPECT_GE(first[0].id.level, 1);
}

TEST(CoreMeshCache, ImagesOfASkinAreAsFineAsItsPosesAreLarge) {
  ObjectModel model = triangles_of(1, 0);
  const double bind = image_uses(model)[0].uv_per_unit;
  auto animation = std::make_shared<Animation>();
  animation->clip_s = 1;
  animation->joints.resize(1);
  animation->joints[0].moves = true;
  animation->joints[0].scale = glm::vec3(20);  // an armature in another unit than its mesh
  animation->bindings.resize(1);
  animation->vertices.resize(model.mesh.vertices.size());
  model.animation = animation;
  EXPECT_NEAR(image_uses(model)[0].uv_per_unit, bind / 20, 1e-6);
}

TEST(CoreMeshCache, ImagesBySize) {
  World world;
  world.cache.add_mesh(0, 0, triangles_of(100, 0), 0);
  world.look_from(300);
  std::vector<AssetNeed> needs = world.needs();
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_EQ(needs[0].id.kind, AssetId::Kind::kImage);
  EXPECT_EQ(needs[0].id.level, 0);
  world.cache.add_image(world.scene, 0, 0, 2000, 0);
  EXPECT_TRUE(world.needs().empty()) << "sharp enough from here";
  // Half a texture for a unit: level 2 (1024 texels) has 512 texels a unit.
  const double f = world.camera.focal_px();
  world.look_from(1 + f * 0.75 / 128 * 0.9);  // too near for level 1 with its 256 texels
  needs = world.needs();
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_EQ(needs[0].id.level, 2);
  world.cache.add_image(world.scene, 0, 2, 200'000, 0);
  EXPECT_TRUE(world.needs().empty());
}

TEST(CoreMeshCache, AnAlphaTestWaitsForItsImage) {
  World world;
  world.cache.add_mesh(0, 0, triangles_of(9000, 1, true), 0);
  EXPECT_FALSE(world.cache.ready()[0]) << "cards would show as slabs";
  world.cache.add_image(world.scene, 1, 0, 1000, 0);
  EXPECT_TRUE(world.cache.ready()[0]);
}

TEST(CoreMeshCache, BoxesAreNearerThanSpheres) {
  World world;
  ObjectDescription& object = world.scene.objects[0];
  object.box_min = {-0.7f, -0.01f, -0.7f};  // a flat thing
  object.box_max = {0.7f, 0.01f, 0.7f};
  world.camera.pose = look_at({0, 0.51, 0}, {0, 0, -0.1});  // inside the sphere
  EXPECT_NEAR(px_per_unit(world.scene, world.camera, 0), world.camera.focal_px() / 0.5, 0.01);
}

}  // namespace
}  // namespace mirage::test
