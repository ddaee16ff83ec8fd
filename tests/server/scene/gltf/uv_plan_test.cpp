#include "server/scene/gltf/uv_plan.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mirage::gltf {
namespace {

using Set = std::vector<glm::vec2>;

const Set kSquare = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.3f, 0.6f}};

Set through(const UvMap& m, const Set& from) {
  Set out;
  for (const glm::vec2& uv : from) {
    out.emplace_back(m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]);
  }
  return out;
}

glm::dvec2 placed(const TextureRef& t, const glm::dvec2& uv) {
  const double c = std::cos(t.rotation), s = std::sin(t.rotation);
  return {t.scale.x * c * uv.x + t.scale.y * s * uv.y + t.offset.x,
          -t.scale.x * s * uv.x + t.scale.y * c * uv.y + t.offset.y};
}

TEST(UvPlan, MapsBetweenSetsAreFound) {
  for (const UvMap& m : {UvMap{1, 0, 0, 0, 1, 0}, UvMap{0, -2, 5, 3, 0, -7},
                         UvMap{0, 0, 0.5, 0, 0, 0.25}, UvMap{0.1, 0.7, 0, -0.4, 0.2, 100}}) {
    const auto found = map_between(kSquare, through(m, kSquare));
    ASSERT_TRUE(found);
    for (std::size_t i = 0; i < m.size(); ++i) EXPECT_NEAR((*found)[i], m[i], 1e-4) << i;
  }
}

TEST(UvPlan, OneCornerElsewhereIsAnotherSet) {
  Set bent = kSquare;
  bent[4].x += 0.001f;
  EXPECT_FALSE(map_between(kSquare, bent));
  EXPECT_FALSE(map_between(kSquare, Set{{0, 0}}));
  EXPECT_FALSE(map_between({}, {}));
  bent[4].x = std::nanf("");
  EXPECT_FALSE(map_between(kSquare, bent));
  EXPECT_FALSE(map_between(Set(5, glm::vec2(0.5f)), kSquare)) << "one point gives no square";
}

TEST(UvPlan, ATextureIsPlacedThroughTurnsFlipsAndScales) {
  TextureRef own;
  own.offset = {0.3f, -2};
  own.rotation = 0.7f;
  own.scale = {1.5f, 1.5f};
  for (const UvMap& m :
       {UvMap{2, 0, 1, 0, 2, -1}, UvMap{0, 1, 0, 1, 0, 0}, UvMap{-1, 0, 1, 0, 1, 0},
        UvMap{0, 0, 0.5, 0, 0, 0.5}, UvMap{0, 0, 0, 0, 3, 0}}) {
    const auto both = placed_through(own, m);
    ASSERT_TRUE(both);
    for (const glm::vec2& uv : kSquare) {
      const glm::dvec2 wanted = placed(own, through(m, {uv})[0]), got = placed(*both, uv);
      EXPECT_NEAR(got.x, wanted.x, 1e-5);
      EXPECT_NEAR(got.y, wanted.y, 1e-5);
    }
  }
}

TEST(UvPlan, AShearedTextureCannotBePlaced) {
  TextureRef turned;
  turned.rotation = 0.7f;
  EXPECT_FALSE(placed_through(TextureRef{}, {1, 0.5, 0, 0, 1, 0}));
  turned.scale = {1, 3};
  EXPECT_FALSE(placed_through(turned, {1, 1, 0, -1, 1, 0}));
}

TEST(UvPlan, AShearedSetKeepsItsOwnPlace) {
  Material m;
  m.base_color_map.image = m.emissive_map.image = m.occlusion_map.image = 0;
  m.emissive_map.uv_set = 2;
  m.occlusion_map.uv_set = 3;
  const std::vector<Set> sets = {kSquare, {}, through({1, 0.5, 0, 0, 1, 0}, kSquare), kSquare};
  const UvPlan plan = plan_uv_sets(m, [&](int set) { return sets[static_cast<std::size_t>(set)]; });
  EXPECT_EQ(plan.kept, (std::array<int, 2>{0, 2}));
  ASSERT_EQ(plan.computed.size(), 1u);
  EXPECT_EQ(plan.computed[0].set, 3);
  EXPECT_EQ(apply(plan, m), 0u);
  EXPECT_EQ(m.emissive_map.uv_set, 1);
  EXPECT_EQ(m.occlusion_map.uv_set, 0);
}

// Without its map, a surface would emit light everywhere.
TEST(UvPlan, ALostEmissiveMapEmitsNothing) {
  Material m;
  m.base_color_map.image = m.emissive_map.image = m.normal_map.image = 0;
  m.emissive = glm::vec3(2);
  UvPlan plan;
  plan.lost = {4};
  m.emissive_map.uv_set = 4;
  EXPECT_EQ(apply(plan, m), 1u);
  EXPECT_FALSE(m.emissive_map.present());
  EXPECT_EQ(m.emissive, glm::vec3(0));
  EXPECT_TRUE(m.normal_map.present());
}

}  // namespace
}  // namespace mirage::gltf
