// Answered keys: what has been answered is not asked for again while the eye stands.
#include "client/ask/answered_keys.h"

#include <gtest/gtest.h>

namespace mirage {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

TileNeed need(std::uint32_t instance, std::uint8_t size_class = 5) {
  TileNeed out;
  out.instance = instance;
  out.cell = {7, 3, 4};
  out.size_class = size_class;
  out.light = 1;
  return out;
}

std::size_t left(AnsweredKeys& keys, TileNeed one, bool stands, std::int64_t now_us) {
  std::vector<TileNeed> needs = {one};
  keys.remove_from(needs, stands, now_us);
  return needs.size();
}

TEST(CoreAnsweredKeys, AnAnsweredKeyIsNoNeedWhileTheEyeStands) {
  AnsweredKeys keys;
  EXPECT_EQ(left(keys, need(1), true, 0), 1u);
  keys.note(need(1), 0);
  EXPECT_EQ(left(keys, need(1), true, 0), 0u);
  EXPECT_EQ(left(keys, need(1), true, 3600 * kSecond), 0u) << "however long it stands";
  EXPECT_EQ(left(keys, need(2), true, 0), 1u) << "another instance";
  EXPECT_EQ(left(keys, need(1, 6), true, 0), 1u) << "a finer one";
  TileNeed relit = need(1);
  relit.light = 2;
  EXPECT_EQ(left(keys, relit, true, 0), 1u) << "another light";
  keys.reset();
  EXPECT_EQ(left(keys, need(1), true, 0), 1u);
}

TEST(CoreAnsweredKeys, AnEyeThatMovedMayAskAgainAfterAWhile) {
  AnsweredKeys keys;
  keys.note(need(1), 0);
  EXPECT_EQ(left(keys, need(1), false, kSecond), 0u) << "not at every step";
  EXPECT_EQ(left(keys, need(1), true, 3 * kSecond), 1u) << "it moved, and stands elsewhere now";
  keys.note(need(1), 4 * kSecond);
  EXPECT_EQ(left(keys, need(1), true, 9 * kSecond), 0u) << "answered since it stands";
}

TEST(CoreAnsweredKeys, PosesOfMovingObjectsAreNeededInEveryLoop) {
  AnsweredKeys keys;
  TileNeed pose = need(1);
  pose.phase = Phase{3};
  keys.note(pose, 0);
  EXPECT_EQ(left(keys, pose, true, 0), 1u);
}

}  // namespace
}  // namespace mirage
