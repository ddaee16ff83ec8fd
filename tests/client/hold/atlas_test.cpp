// Atlas allocator: no overlap, and nothing lost after any order of releases (numerics.md T1-5).
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "client/hold/atlas_allocator.h"

namespace mirage::test {
namespace {

constexpr int kEdge = 256;
constexpr int kLayers = 3;

/// Owner of each texel, by slot number; 0: none.
class Occupancy {
 public:
  bool claim(const AtlasSlot& slot, int owner) {
    bool free = true;
    for_each(slot, [&](int& texel) {
      free = free && texel == 0;
      texel = owner;
    });
    return free;
  }
  bool release(const AtlasSlot& slot, int owner) {
    bool intact = true;
    for_each(slot, [&](int& texel) {
      intact = intact && texel == owner;
      texel = 0;
    });
    return intact;
  }

 private:
  template <typename Visit>
  void for_each(const AtlasSlot& slot, Visit visit) {
    for (int y = slot.y; y < slot.y + slot.h; ++y) {
      for (int x = slot.x; x < slot.x + slot.w; ++x) {
        visit(texels_[static_cast<std::size_t>((slot.layer * kEdge + y) * kEdge + x)]);
      }
    }
  }
  std::vector<int> texels_ = std::vector<int>(std::size_t{kLayers} * kEdge * kEdge, 0);
};

bool inside(const AtlasSlot& s) {
  return s.layer >= 0 && s.layer < kLayers && s.x >= 0 && s.y >= 0 && s.x + s.w <= kEdge &&
         s.y + s.h <= kEdge;
}

TEST(CoreAtlas, RandomAllocationsNeverOverlapAndLeaveNothingBehind) {
  AtlasAllocator atlas(kEdge, kLayers);
  Occupancy occupancy;
  std::mt19937 random(1);
  struct Live {
    AtlasSlot slot;
    int owner;
  };
  std::vector<Live> live;
  int refused = 0;
  for (int i = 1; i <= 100'000; ++i) {
    // Grows and shrinks in turn, so that the atlas is full and nearly empty many times.
    const bool grow = (i / 500) % 2 == 0 ? random() % 4 != 0 : random() % 4 == 0;
    if (grow || live.empty()) {
      const int widest = random() % 50 == 0 ? kEdge : 40;
      const int w = 1 + static_cast<int>(random() % static_cast<unsigned>(widest));
      const int h = 1 + static_cast<int>(random() % static_cast<unsigned>(widest));
      const auto slot = atlas.allocate(w, h);
      if (!slot) {
        ++refused;
        continue;
      }
      ASSERT_EQ(slot->w, w);
      ASSERT_EQ(slot->h, h);
      ASSERT_TRUE(inside(*slot));
      ASSERT_TRUE(occupancy.claim(*slot, i)) << "overlap at allocation " << i;
      live.push_back({*slot, i});
    } else {
      const std::size_t k = random() % live.size();
      ASSERT_TRUE(occupancy.release(live[k].slot, live[k].owner));
      atlas.release(live[k].slot);
      live[k] = live.back();
      live.pop_back();
    }
    std::size_t texels = 0;
    if (i % 1000 == 0) {
      for (const Live& l : live) texels += static_cast<std::size_t>(l.slot.w * l.slot.h);
      ASSERT_GE(atlas.used_texels(), texels);
      ASSERT_LE(atlas.used_texels(), std::size_t{kLayers} * kEdge * kEdge);
    }
  }
  EXPECT_GT(refused, 100) << "the atlas was never full: nothing was tried";
  for (const Live& l : live) atlas.release(l.slot);
  EXPECT_EQ(atlas.used_texels(), 0u);
  for (int i = 0; i < kLayers; ++i) EXPECT_TRUE(atlas.allocate(kEdge, kEdge)) << "layer " << i;
  EXPECT_FALSE(atlas.allocate(1, 1));
}

TEST(CoreAtlas, UsedTexelsCountTheRoundedSlot) {
  AtlasAllocator atlas(kEdge, 1);
  const auto a = atlas.allocate(17, 16);  // 24 wide, the lowest shelf is 16
  ASSERT_TRUE(a);
  EXPECT_EQ(atlas.used_texels(), 24u * 16u);
  const auto b = atlas.allocate(8, 17);  // the next shelf up: 16 + 16 / 4, in steps of 8
  ASSERT_TRUE(b);
  EXPECT_EQ(atlas.used_texels(), 24u * 16u + 8u * 24u);
  atlas.release(*a);
  EXPECT_EQ(atlas.used_texels(), 8u * 24u);
  atlas.release(*b);
  EXPECT_EQ(atlas.used_texels(), 0u);
}

TEST(CoreAtlas, RefusesWhatCannotFit) {
  AtlasAllocator atlas(kEdge, kLayers);
  for (const auto& [w, h] : {std::pair{kEdge + 1, 1}, {1, kEdge + 1}, {0, 1}, {1, 0}, {-1, 8}}) {
    EXPECT_FALSE(atlas.allocate(w, h)) << w << " x " << h;
  }
  EXPECT_EQ(atlas.used_texels(), 0u);
  EXPECT_TRUE(atlas.allocate(kEdge, kEdge));
}

TEST(CoreAtlas, EdgeThatIsNoMultipleOfTheGrain) {
  AtlasAllocator atlas(100, 1);
  const auto whole = atlas.allocate(100, 100);
  ASSERT_TRUE(whole);
  EXPECT_FALSE(atlas.allocate(1, 1));
  atlas.release(*whole);
  EXPECT_EQ(atlas.used_texels(), 0u);
  EXPECT_TRUE(atlas.allocate(99, 97));
}

}  // namespace
}  // namespace mirage::test
