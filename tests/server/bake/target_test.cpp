#include "server/bake/target.h"

#include <gtest/gtest.h>

namespace mirage {
namespace {

std::vector<std::string> warnings(const char* target, int grid, int tile,
                                  BakeLayout layout = BakeLayout::kHemi) {
  const auto found = check_target(*target_of(target), layout, grid, tile);
  EXPECT_TRUE(found) << found.error().line();
  return found ? *found : std::vector<std::string>{};
}

std::string refusal(const char* target, int grid, int tile, BakeLayout layout = BakeLayout::kHemi) {
  const auto found = check_target(*target_of(target), layout, grid, tile);
  EXPECT_FALSE(found) << target;
  if (found) return {};
  EXPECT_EQ(found.error().id, ErrorId::kUsage);
  return found.error().text;
}

TEST(BakeTarget, AreEight) {
  EXPECT_EQ(bake_targets().size(), 8u);
  EXPECT_EQ(target_of("unity"), nullptr);
  for (const auto& target : bake_targets()) {
    EXPECT_EQ(target_of(target.name), &target);
    const auto usual = check_target(target, target.layouts.at(0), target.grid, target.tile);
    ASSERT_TRUE(usual) << target.name;
    if (target.name != "godot3") {
      EXPECT_TRUE(usual->empty()) << target.name << ": " << usual->at(0);
    }
    EXPECT_EQ(target.commit.empty(), target.name == "generic");
  }
}

TEST(BakeTarget, SayWhatTheyCannotShow) {
  EXPECT_NE(refusal("unity-imp", 15, 128).find("NaN"), std::string::npos);
  EXPECT_NE(refusal("unity-imp", 34, 32).find("4 to 32"), std::string::npos);
  EXPECT_NE(refusal("unity-imp", 2, 32).find("4 to 32"), std::string::npos);
  EXPECT_NE(refusal("three", 16, 128, BakeLayout::kOctahedral).find("octahedral"),
            std::string::npos);
  refusal("unity-imp", 16, 128, BakeLayout::kOctahedral);
  refusal("godot4", 16, 128, BakeLayout::kRing);
  refusal("generic", 1, 128);
  refusal("generic", 65, 128);
  refusal("generic", 16, 0);
}

TEST(BakeTarget, WarnOfWhatTheyShowBadly) {
  EXPECT_TRUE(warnings("unity-imp", 16, 128).empty());
  EXPECT_EQ(warnings("unity-imp", 12, 100).size(), 1u) << "no power of two";
  EXPECT_EQ(warnings("unreal", 12, 128).size(), 1u);
  EXPECT_EQ(warnings("unreal", 16, 128, BakeLayout::kOctahedral).size(), 2u);
  EXPECT_EQ(warnings("godot4", 15, 128).size(), 1u);
  EXPECT_EQ(warnings("godot4", 26, 64).size(), 1u);
  EXPECT_EQ(warnings("godot4", 27, 64).size(), 1u) << "odd and above 24 have one reason";
  EXPECT_TRUE(warnings("godot4", 24, 64).empty());
  EXPECT_TRUE(warnings("three-tsl", 17, 240).empty());
  EXPECT_EQ(warnings("three-tsl", 16, 256).size(), 1u);
  EXPECT_TRUE(warnings("boimp", 4, 64, BakeLayout::kRing).empty());
}

TEST(BakeTarget, FrameTheSphereOrTheLongestEdge) {
  const glm::dvec3 box(1, 2, 3);
  EXPECT_DOUBLE_EQ(framed_radius(*target_of("three-tsl"), 9, box, 240), 1.5 / .72);
  EXPECT_DOUBLE_EQ(framed_radius(*target_of("godot4"), 9, box, 128), 9);
  // Two texels on either side are left.
  EXPECT_DOUBLE_EQ(framed_radius(*target_of("unreal"), 9, box, 128), 9 * 128 / 124.0);
}

// Rolls agree wherever no frame is near enough to the pole for the rules to differ.
TEST(BakeTarget, ShareCapturesOfTheSameRoll) {
  const auto alike = [](const char* a, const char* b, int grid) {
    return rolled_alike(target_of(a)->roll, target_of(b)->roll, BakeLayout::kHemi, grid);
  };
  for (const int grid : {4, 8}) {
    for (const auto& target : bake_targets()) {
      EXPECT_TRUE(rolled_alike(target_of("generic")->roll, target.roll, BakeLayout::kHemi, grid));
    }
  }
  EXPECT_FALSE(alike("generic", "boimp", 10));
  EXPECT_TRUE(alike("three", "godot4", 24));
  EXPECT_FALSE(alike("three", "godot4", 26));
  EXPECT_FALSE(alike("generic", "unreal", 9));
}

TEST(BakeTarget, OrderFramesAsConsumersDo) {
  EXPECT_EQ(captured_frame(FrameOrder::kSame, 8, 2, 3), glm::ivec2(2, 3));
  EXPECT_EQ(captured_frame(FrameOrder::kMirrorJ, 8, 2, 3), glm::ivec2(2, 4));
  EXPECT_EQ(captured_frame(FrameOrder::kQuarterTurn, 8, 2, 3), glm::ivec2(4, 2));
}

}  // namespace
}  // namespace mirage
