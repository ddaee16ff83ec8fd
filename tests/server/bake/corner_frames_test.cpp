// The four corner frames of a hemi bake look along the ground, where it is plain to see which bar
// must point where. For each consumer: the directions it gives those frames, and where in the file
// it looks for them.

#include <gtest/gtest.h>

#include "tests/server/bake/arrows.h"
#include "tests/server/bake/baked.h"

namespace mirage {
namespace {

using glm::dvec3;

constexpr int kGrid = 6, kTile = 64;
const dvec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

struct Corners {
  const char* target;
  dvec3 directions[4];  // of frames (0, 0), (N - 1, 0), (0, N - 1), (N - 1, N - 1); glTF
  bool row_0_at_bottom, upside_down;
};
const Corners kCorners[] = {
    {"generic", {-kZ, kX, -kX, kZ}, false, false},  {"three", {-kZ, kX, -kX, kZ}, true, false},
    {"three-tsl", {-kZ, kX, -kX, kZ}, false, true}, {"godot4", {-kZ, kX, -kX, kZ}, false, false},
    {"godot3", {-kZ, kX, -kX, kZ}, false, false},   {"unity-imp", {kX, kZ, -kZ, -kX}, true, false},
    {"unreal", {-kX, kZ, -kZ, kX}, false, false},   {"boimp", {-kZ, kX, -kX, kZ}, false, false},
};

struct Tip {
  const char* name;
  dvec3 from_center;
  dvec3 color;
};
const Tip kTips[] = {{"red", kX*(kRedEnd - .05), {1, 0, 0}},
                     {"green", kY*(kGreenEnd - .05), {0, 1, 0}},
                     {"blue", kZ*(kBlueEnd - .05), {0, 0, 1}}};

class CornerFrames : public testing::TestWithParam<Corners> {
 protected:
  // Returns the colour at a place of a frame in the file: 0 to 1 to the right and down.
  dvec3 color_at(const Baked& bake, int i, int j, double right, double down) const {
    const Corners& c = GetParam();
    const int y = int(down * kTile);
    const int row = c.row_0_at_bottom ? kGrid - 1 - j : j;
    const int px = i * kTile + int(right * kTile);
    const int py = row * kTile + (c.upside_down ? kTile - 1 - y : y);
    std::map<std::string, glm::dvec4> raw;
    for (const auto& [map, picture] : bake.pictures) raw[map] = picture.at(px, py);
    return consumer::named(c.target).decode(raw, {kX, kY}, kZ).color;
  }
};

TEST_P(CornerFrames, ShowTheBarsWhereTheConsumerLooks) {
  const Baked bake = baked_arrows(GetParam().target, BakeLayout::kHemi, kGrid, kTile);
  for (int corner = 0; corner < 4; ++corner) {
    const dvec3 toward = GetParam().directions[corner], right = cross(kY, toward);
    const int i = corner % 2 ? kGrid - 1 : 0, j = corner / 2 ? kGrid - 1 : 0;
    for (const Tip& tip : kTips) {
      if (dot(tip.from_center, toward) < -.1) continue;  // it points away
      const dvec3 seen =
          color_at(bake, i, j, .5 + dot(tip.from_center, right) / 2, .5 - tip.from_center.y / 2);
      EXPECT_LT(distance(seen, tip.color), .1) << tip.name << " in frame " << i << " " << j;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, CornerFrames, testing::ValuesIn(kCorners), [](const auto& info) {
  std::string name = info.param.target;
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
});

}  // namespace
}  // namespace mirage
