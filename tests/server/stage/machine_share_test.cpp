// Machine share: threads by cores and renderer.
#include "server/stage/machine_share.h"

#include <gtest/gtest.h>
#include <sched.h>

namespace mirage::test {
namespace {

TEST(ServerMachineShare, EncodersByCoresAndRenderer) {
  constexpr bool kSoftware = true, kCard = false;
  EXPECT_EQ(encoders_for(16, kCard), 14);
  EXPECT_EQ(encoders_for(8, kCard), 6);
  EXPECT_EQ(encoders_for(2, kCard), 1);
  EXPECT_EQ(encoders_for(1, kCard), 1);
  EXPECT_EQ(encoders_for(128, kCard), 14);
  EXPECT_EQ(encoders_for(2, kSoftware), 1);
  EXPECT_EQ(encoders_for(16, kSoftware), 1);
}

TEST(ServerMachineShare, CoresAreThoseThatTheProcessMayUse) {
  cpu_set_t before;
  ASSERT_EQ(sched_getaffinity(0, sizeof(before), &before), 0);
  EXPECT_EQ(usable_cores(), CPU_COUNT(&before));
  cpu_set_t one;
  CPU_ZERO(&one);
  for (std::size_t core = 0; CPU_COUNT(&one) == 0; ++core) {
    if (CPU_ISSET(core, &before)) CPU_SET(core, &one);
  }
  ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
  EXPECT_EQ(usable_cores(), 1);
  sched_setaffinity(0, sizeof(before), &before);
}

}  // namespace
}  // namespace mirage::test
