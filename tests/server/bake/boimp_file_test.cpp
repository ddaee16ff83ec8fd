#include "server/bake/boimp_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/server/bake/arrows.h"
#include "tests/server/bake/baked.h"

namespace mirage {
namespace {

TEST(BoimpTexel, HasEachFieldInItsBits) {
  FrameTexel texel;
  texel.coverage = 1;
  texel.color = {1, 0, 0};
  texel.normal = {0, 1, 0};
  texel.depth = 1;
  texel.orm = {0, 1, 0};
  // Straight up is the middle of the square, 2047.5 of 4095.
  EXPECT_EQ(boimp_texel(texel),
            (BoimpTexel{31u | 31u << 15 | 15u << 20, 2048u | 2048u << 12 | 255u << 24}));
  texel.color = {0, 1, 0};
  texel.normal = {-1, 0, 0};
  texel.depth = -1;
  texel.orm = {0, 0, 1};
  EXPECT_EQ(boimp_texel(texel), (BoimpTexel{31u << 5 | 31u << 15 | 15u << 24, 2048u << 12}));
  texel.color = {0, 0, 1};
  texel.normal = {0, -1, 0};
  texel.coverage = .6f;
  texel.orm = {0, 0, 0};
  EXPECT_EQ(boimp_texel(texel), (BoimpTexel{31u << 10 | 19u << 15, 4095u | 4095u << 12}));
  texel.coverage = .49f;
  EXPECT_EQ(boimp_texel(texel), (BoimpTexel{0, 0}));
}

TEST(BoimpFile, IsTheSameForTheSameBake) {
  const TargetFacts& target = *target_of("boimp");
  const BakeMaster master = arrows_master(BakeLayout::kHemi, 4, 32, target.roll);
  const auto a = boimp_file(master, target), b = boimp_file(master, target);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(*a, *b);
}

// The object reaches neither the top nor the bottom of any frame.
TEST(BoimpFile, LeavesOutWhatIsEmptyInEachFrame) {
  const Baked bake = baked_arrows("boimp", BakeLayout::kHemi, 6, 40);
  const Boimp file = read_boimp(bake.files.binaries.at(0).bytes);
  int top = 40, bottom = -1, left = 40, right = -1;
  for (std::size_t at = 0; at < bake.master.texels(); ++at) {
    if (bake.master.color[at].a < .5f) continue;
    const int x = int(at) % 40, y = int(at) / 40 % 40;
    left = std::min(left, x), right = std::max(right, x);
    top = std::min(top, y), bottom = std::max(bottom, y);
  }
  const auto text = [](int n) { return " " + std::to_string(n); };
  EXPECT_EQ(file.settings, "6 2.5 hemispherical 40" + text(left) + text(top) +
                               text(right - left + 1) + text(bottom - top + 1));
  EXPECT_EQ(file.names, (std::vector<std::string>{"indices.png", "pixels.png", "settings.txt"}));
}

// Numbers of texels pay only if texels repeat; an odd width needs a filler at each row's end.
TEST(BoimpFile, HasPlainTexelsWhereNoneRepeat) {
  const TargetFacts& target = *target_of("boimp");
  BakeMaster master;
  master.roll = target.roll;
  master.grid = 3;
  master.tile = 5;
  master.clear();
  for (std::size_t at = 0; at < master.texels(); ++at) {
    master.color[at] = {1, 1, 1, 1};
    master.normal[at] = normalize(glm::vec3(float(at) + 1, 100, float(at * at % 97)));
  }
  const auto plain = boimp_file(master, target);
  ASSERT_TRUE(plain);
  EXPECT_EQ(read_boimp(*plain).names, (std::vector<std::string>{"settings.txt", "texture.png"}));
  const consumer::Pictures before = read_boimp(*plain).words;
  for (std::size_t at = 50; at < master.texels(); ++at) master.normal[at] = master.normal[at % 50];
  for (auto& n : master.normal) n = n.x > .5f ? glm::vec3(1, 0, 0) : n;
  const auto numbered = boimp_file(master, target);
  ASSERT_TRUE(numbered);
  const Boimp file = read_boimp(*numbered);
  ASSERT_EQ(file.names.size(), 3u);
  EXPECT_EQ(file.settings, "3 1 hemispherical 5 0 0 5 5");
  EXPECT_NE(file.words.at("word 1").bytes, before.at("word 1").bytes);
  for (int f = 0; f < 9; ++f) {
    for (int t = 0; t < 25; ++t) {
      const auto texel = boimp_texel(FrameTexels(master, target, f * 25).at(t));
      const int x = f % 3 * 5 + t % 5, y = f / 3 * 5 + t / 5;
      for (int b = 0; b < 4; ++b) {
        EXPECT_EQ(file.words.at("word 1").bytes.at((y * 15 + x) * 4 + b),
                  texel[1] >> (8 * b) & 255);
      }
    }
  }
}

TEST(BoimpFile, OfNothingHasOneTexel) {
  const TargetFacts& target = *target_of("boimp");
  BakeMaster master;
  master.roll = target.roll;
  master.grid = 2;
  master.tile = 8;
  master.clear();
  const auto file = boimp_file(master, target);
  ASSERT_TRUE(file);
  EXPECT_EQ(read_boimp(*file).settings, "2 1 hemispherical 8 0 0 1 1");
}

}  // namespace
}  // namespace mirage
