// The rest of an export, beside putting frames in their places: backgrounds, filling, coverage,
// choices and refusals.

#include "server/bake/export.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/bake/arrows.h"
#include "tests/server/bake/baked.h"

namespace mirage {
namespace {

constexpr int kSide = 64;

// A frame in which one texel, off the middle, has half its area covered.
constexpr int kDotX = 20, kDotY = 24;
BakeMaster dot_master(const TargetFacts& target) {
  BakeMaster master;
  master.roll = target.roll;
  master.grid = 4;
  master.tile = kSide;
  master.clear();
  for (int f = 0; f < master.frames(); ++f) {
    const std::size_t at = std::size_t(f) * kSide * kSide + kDotY * kSide + kDotX;
    master.color[at] = {.2f, .1f, .05f, .5f};
    master.normal[at] = {1, 0, 0};
    master.depth[at] = .5f;
    master.orm[at] = {.9f, .25f, .75f};
  }
  return master;
}

const BakeImage& image_of(const BakeExport& files, const std::string& map) {
  for (const auto& image : files.images) {
    if (image.map == map) return image;
  }
  throw std::out_of_range(map);
}

// Returns a texel of frame (1, 1), counted from where the dot is.
glm::vec4 texel_of(const BakeExport& files, const TargetFacts& target, const std::string& map,
                   int dx, int dy) {
  const BakeImage& image = image_of(files, map);
  const glm::ivec2 p =
      consumer::named(std::string(target.name)).pixel(4, kSide, 1, 1, kDotX + dx, kDotY + dy);
  glm::vec4 out(0, 0, 0, 1);
  for (int c = 0; c < image.channels; ++c) {
    out[c] = image.texels.at((std::size_t(p.y) * image.width + p.x) * image.channels + c);
  }
  return out;
}

BakeExport exported(const TargetFacts& target, const ExportChoice& choice = {}) {
  auto files = export_bake(dot_master(target), target, choice);
  EXPECT_TRUE(files) << files.error().line();
  return files.take();
}

float srgb(float v) { return 1.055f * std::pow(v, 1 / 2.4f) - .055f; }

TEST(BakeExport, KeepsPremultipliedColours) {
  const TargetFacts& target = *target_of("generic");
  const BakeExport files = exported(target);
  const glm::vec4 dot = texel_of(files, target, "color", 0, 0);
  EXPECT_NEAR(dot.r, srgb(.2f), 1e-5);
  EXPECT_NEAR(dot.a, .5f, 1e-6);
  EXPECT_EQ(texel_of(files, target, "color", 1, 0), glm::vec4(0));
}

TEST(BakeExport, StraightensAndSpreadsColours) {
  const TargetFacts& target = *target_of("godot4");
  const BakeExport files = exported(target);
  for (const int away : {0, 1, 32}) {
    EXPECT_NEAR(texel_of(files, target, "color", away, 0).r, srgb(.4f), 1e-5) << away;
    EXPECT_EQ(texel_of(files, target, "color", away, 0).a, away == 0 ? .5f : 0) << away;
  }
  EXPECT_EQ(texel_of(files, target, "color", 33, 0).r, 0);
}

TEST(BakeExport, LeavesColoursLinearOnRequest) {
  const TargetFacts& target = *target_of("generic");
  const BakeExport files = exported(target, {"dot", {"color"}, true});
  EXPECT_NEAR(texel_of(files, target, "color", 0, 0).r, .2f, 1e-6);
  EXPECT_FALSE(image_of(files, "color").srgb);
  EXPECT_EQ(files.maps.at(0).color_space, "linear");
}

// Far from the object, and beside it, where filters reach.
TEST(BakeExport, HasTheBackgroundThatConsumersExpect) {
  for (const char* name : {"unity-imp", "unreal", "three", "godot4"}) {
    const TargetFacts& target = *target_of(name);
    const BakeExport files = exported(target);
    const bool godot = std::string(name) == "godot4";
    const char* map = godot ? "depth" : "normal";
    const int channel = godot ? 0 : 3;
    const float near = texel_of(files, target, map, 3, 4)[channel];
    EXPECT_NEAR(near, godot ? .25f : .75f, 1e-6) << name;
    EXPECT_EQ(texel_of(files, target, map, 40, 30)[channel], .5f) << name;
    for (const auto& facts : files.maps) {
      if (facts.map == map) {
        EXPECT_EQ(facts.background.at(channel), .5f) << name;
      }
    }
  }
  const TargetFacts& generic = *target_of("generic");
  EXPECT_NEAR(texel_of(exported(generic), generic, "normal", 40, 30).a, .75f, 1e-6)
      << "it is filled up to the edge";
}

TEST(BakeExport, GivesFieldsInPlaceOfCoverage) {
  const TargetFacts& unity = *target_of("unity-imp");
  const BakeExport imp = exported(unity);
  EXPECT_NEAR(texel_of(imp, unity, "color", 0, 0).a, 1 / unity.field_reach, 1e-6);
  EXPECT_EQ(texel_of(imp, unity, "color", 1, 0).a, 0);
  // Halfway to the next texel, filtering gives the value at which the consumer cuts.
  EXPECT_NEAR(.5f / unity.field_reach, std::pow(.3, 1 / .3), 2e-4);
  const TargetFacts& unreal = *target_of("unreal");
  const BakeExport ue = exported(unreal);
  EXPECT_NEAR(texel_of(ue, unreal, "color", 0, 0).a + texel_of(ue, unreal, "color", 1, 0).a, 1,
              1e-6);
  EXPECT_GT(texel_of(ue, unreal, "color", 0, 0).a, .51f);
  EXPECT_EQ(texel_of(ue, unreal, "color", 30, 30).a, 0);
}

TEST(BakeExport, ClearsTheBorderOfUnitysFrames) {
  const TargetFacts& target = *target_of("unity-imp");
  BakeMaster master = dot_master(target);
  for (auto& color : master.color) color = glm::vec4(1);
  const auto files = export_bake(master, target, {});
  ASSERT_TRUE(files);
  EXPECT_EQ(texel_of(*files, target, "color", -kDotX, 0).a, 0);
  EXPECT_GT(texel_of(*files, target, "color", 1 - kDotX, 0).a, .03f);
}

TEST(BakeExport, WritesTheMapsThatAreWanted) {
  const TargetFacts& generic = *target_of("generic");
  EXPECT_EQ(exported(generic).images.size(), 3u) << "depth is in the normal map";
  const BakeExport depth = exported(generic, {"x", {"depth"}, false});
  ASSERT_EQ(depth.images.size(), 1u);
  EXPECT_EQ(depth.images[0].file, "x.depth.png");
  EXPECT_EQ(depth.images[0].channels, 1);
  EXPECT_EQ(depth.maps[0].depth, "s = (value - .5) * 2 * radius");
  const TargetFacts& unity = *target_of("unity-imp");
  const BakeExport packed = exported(unity, {"x", {"depth", "normal"}, false});
  ASSERT_EQ(packed.images.size(), 1u);
  EXPECT_EQ(packed.images[0].file, "x_ImposterPack.png");
  EXPECT_EQ(packed.maps[0].depth, "s = (a - .5) * 2 * radius");
  const auto none = export_bake(dot_master(unity), unity, {"x", {"orm"}, false});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().id, ErrorId::kUsage);
}

TEST(BakeExport, MakesNamesHarmless) {
  EXPECT_EQ(file_name_of("../a b\"\n$é.glb"), "___a_b______glb");
  EXPECT_EQ(file_name_of(""), "object");
  EXPECT_EQ(file_name_of(std::string(300, 'x')).size(), 64u);
  EXPECT_EQ(exported(*target_of("godot3"), {"a/b", {}, false}).images[0].file,
            "a_b/result_albedo.png");
}

TEST(BakeExport, RefusesACaptureOfAnotherRoll) {
  BakeMaster master = arrows_master(BakeLayout::kHemi, 12, 4, target_of("generic")->roll);
  const auto rolled = export_bake(master, *target_of("boimp"), {});
  ASSERT_FALSE(rolled);
  EXPECT_EQ(rolled.error().id, ErrorId::kUsage);
  EXPECT_TRUE(export_bake(master, *target_of("godot4"), {})) << "no frame is that near the pole";
  master.depth.clear();
  const auto torn = export_bake(master, *target_of("godot4"), {});
  ASSERT_FALSE(torn);
  EXPECT_EQ(torn.error().id, ErrorId::kInternal);
}

}  // namespace
}  // namespace mirage
