#include "tests/relay/packet_direction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace mirage::test {
namespace {

constexpr int kMany = 20'000;

/// Sends many packets of 1250 bytes, one a millisecond. Returns the numbers of those that arrived,
/// in order.
std::vector<int> sent_through(PacketDirection& way) {
  std::vector<int> out;
  const auto take = [&](std::int64_t now_us) {
    while (const std::optional<std::string> packet = way.take(now_us)) {
      out.push_back(std::stoi(*packet));
    }
  };
  for (int i = 0; i < kMany; ++i) {
    std::string packet = std::to_string(i);
    packet.resize(1250, ' ');
    way.put(std::move(packet), i * 1000);
    take(i * 1000);
  }
  take(INT64_MAX - 1);
  return out;
}

TEST(PacketDirection, DelaysByItsTimeAndByTheRate) {
  PacketShape shape;
  shape.delay_ms = 20;
  shape.rate_mbps = 10;  // 1250 bytes a millisecond
  PacketDirection way(shape);
  way.put(std::string(1250, 'a'), 0);
  way.put(std::string(1250, 'b'), 0);
  EXPECT_FALSE(way.take(20'999));
  EXPECT_EQ(way.next_us(), 21'000);
  EXPECT_TRUE(way.take(21'000));
  EXPECT_EQ(way.next_us(), 22'000);
}

TEST(PacketDirection, LosesTheShareThatItIsTold) {
  PacketShape shape;
  shape.loss_percent = 1;
  PacketDirection way(shape);
  const std::vector<int> came = sent_through(way);
  EXPECT_EQ(came.size() + way.counts().lost, std::size_t{kMany});
  EXPECT_NEAR(static_cast<double>(way.counts().lost), 200, 5 * 14);  // five standard deviations
  EXPECT_TRUE(std::is_sorted(came.begin(), came.end()));
}

TEST(PacketDirection, LetsSomeBeOvertaken) {
  PacketShape shape;
  shape.reorder_percent = 1;
  PacketDirection way(shape);
  const std::vector<int> came = sent_through(way);
  EXPECT_EQ(came.size(), std::size_t{kMany});
  std::size_t overtaken = 0;
  for (std::size_t i = 0; i + 1 < came.size(); ++i) overtaken += came[i] > came[i + 1] ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(overtaken), 200, 5 * 14);
}

TEST(PacketDirection, DropsWhatItsBufferDoesNotHold) {
  PacketShape shape;
  shape.rate_mbps = 5;  // half of what is sent
  shape.buffer_ms = 100;
  PacketDirection way(shape);
  const std::vector<int> came = sent_through(way);
  EXPECT_NEAR(static_cast<double>(came.size()), kMany / 2, 100);
  EXPECT_EQ(came.size() + way.counts().dropped, std::size_t{kMany});
}

}  // namespace
}  // namespace mirage::test
