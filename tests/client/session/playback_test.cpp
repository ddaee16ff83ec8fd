// Playback: the animation stands while it is stopped, and goes on from there.
#include "client/session/playback.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

constexpr std::int64_t kOneSecond = 1'000'000;

TEST(CorePlayback, RunsWithTheSessionAtFirst) {
  const Playback playback;
  EXPECT_TRUE(playback.playing());
  EXPECT_EQ(playback.at(5 * kOneSecond), 5);
}

TEST(CorePlayback, StandsWhileStoppedAndGoesOnFromThere) {
  Playback playback;
  playback.play(false, 3 * kOneSecond);
  EXPECT_FALSE(playback.playing());
  EXPECT_EQ(playback.at(10 * kOneSecond), 3);
  playback.play(false, 11 * kOneSecond);
  EXPECT_EQ(playback.at(12 * kOneSecond), 3) << "stopped twice";
  playback.play(true, 13 * kOneSecond);
  EXPECT_EQ(playback.at(13 * kOneSecond), 3);
  EXPECT_EQ(playback.at(15 * kOneSecond), 5);
  playback.play(true, 16 * kOneSecond);
  EXPECT_EQ(playback.at(16 * kOneSecond), 6) << "started twice";
  playback.play(false, 17 * kOneSecond);
  playback.play(true, 27 * kOneSecond);
  EXPECT_EQ(playback.at(28 * kOneSecond), 8);
}

}  // namespace
}  // namespace mirage::test
