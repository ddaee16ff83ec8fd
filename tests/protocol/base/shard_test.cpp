// Shards as a batch scheduler names them.
#include "protocol/base/shard.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace mirage::test {
namespace {

TEST(Shard, CountsFromZeroOrFromOne) {
  for (const unsigned first : {0u, 1u}) {
    std::array<int, 10> made{};
    for (unsigned i = first; i < first + 4; ++i) {
      const Result<Shard> shard = parse_shard(std::to_string(i) + "/4");
      ASSERT_TRUE(shard) << i;
      for (std::size_t item = 0; item < made.size(); ++item) made[item] += shard->has(item);
    }
    for (const int times : made) EXPECT_EQ(times, 1) << "from " << first;
  }
}

TEST(Shard, RefusesWhatIsNone) {
  for (const char* text : {"", "1", "/4", "1/", "5/4", "1/0", "0/0", "-1/4", "+1/4", " 1/4", "1/-4",
                           "1/4 ", "1/4x", "1.5/4", "99999999999/99999999999", "a/b"}) {
    const Result<Shard> shard = parse_shard(text);
    ASSERT_FALSE(shard) << text;
    EXPECT_EQ(shard.error().id, ErrorId::kUsage) << text;
  }
  EXPECT_TRUE(parse_shard("1/1"));
  EXPECT_TRUE(parse_shard("999999/999999"));
}

}  // namespace
}  // namespace mirage::test
