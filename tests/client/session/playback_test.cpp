// Playback: the animation stands while it is stopped, and goes on from there.
#include "client/session/playback.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

TEST(CorePlayback, RunsWithTheSessionAtFirst) {
  const Playback playback;
  EXPECT_TRUE(playback.playing());
  EXPECT_EQ(playback.at(5 * kSecond), 5);
}

TEST(CorePlayback, StandsWhileStoppedAndGoesOnFromThere) {
  Playback playback;
  playback.play(false, 3 * kSecond);
  EXPECT_FALSE(playback.playing());
  EXPECT_EQ(playback.at(10 * kSecond), 3);
  playback.play(false, 11 * kSecond);
  EXPECT_EQ(playback.at(12 * kSecond), 3) << "stopped twice";
  playback.play(true, 13 * kSecond);
  EXPECT_EQ(playback.at(13 * kSecond), 3);
  EXPECT_EQ(playback.at(15 * kSecond), 5);
  playback.play(true, 16 * kSecond);
  EXPECT_EQ(playback.at(16 * kSecond), 6) << "started twice";
  playback.play(false, 17 * kSecond);
  playback.play(true, 27 * kSecond);
  EXPECT_EQ(playback.at(28 * kSecond), 8);
}

}  // namespace
}  // namespace mirage::test
