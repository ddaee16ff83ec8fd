// Shaped direction: order, delay, rate, outage, and that its sender waits when it is full.
#include "tests/relay/shaped_direction.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

std::string bytes(std::size_t n) {
  std::string out(n, ' ');
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<char>(i * 31 + i / 256);
  return out;
}

/// Takes everything under way into `out`. Returns the time of the last arrival.
std::int64_t run_dry(ShapedDirection& way, std::string& out) {
  std::int64_t now = 0;
  while (way.next_us() != INT64_MAX) {
    now = way.next_us();
    out += way.take(now);
  }
  return now;
}

TEST(ShapedDirection, NothingComesBeforeItsDelayAndAllInOrder) {
  ShapedDirection way({.delay_ms = 50, .jitter_ms = 20});
  const std::string sent = bytes(20'000);
  way.put(sent.data(), 12'000, 1'000);
  way.put(sent.data() + 12'000, 8'000, 1'000);
  EXPECT_EQ(way.take(50'999), "");
  std::string came;
  EXPECT_LE(run_dry(way, came), 71'001);
  EXPECT_EQ(came, sent);
}

TEST(ShapedDirection, ALinkTransmitsAtItsRate) {
  ShapedDirection way({.delay_ms = 10, .rate_mbps = 8});  // a byte a microsecond
  const std::string sent = bytes(100'000);
  way.put(sent.data(), sent.size(), 0);
  std::string came;
  EXPECT_NEAR(static_cast<double>(run_dry(way, came)), 110'000, 100);
  EXPECT_EQ(came, sent);
}

TEST(ShapedDirection, InAnOutageNothingIsTransmitted) {
  ShapedDirection way({.delay_ms = 10, .outage_at_s = 1, .outage_for_s = 2});
  way.put("a", 1, 500'000);
  way.put("b", 1, 1'500'000);
  way.put("c", 1, 3'500'000);
  EXPECT_EQ(way.take(510'000), "a");
  EXPECT_EQ(way.take(3'009'999), "");
  EXPECT_EQ(way.take(3'010'000), "b");
  EXPECT_EQ(way.take(3'510'000), "c");
}

TEST(ShapedDirection, ItsSenderWaitsWhenItIsFull) {
  ShapedDirection way({.delay_ms = 50, .rate_mbps = 8});
  std::size_t sent = 0;
  while (const std::size_t most = way.wants()) {
    const std::string part = bytes(most);
    way.put(part.data(), part.size(), 0);
    sent += most;
  }
  EXPECT_NEAR(static_cast<double>(sent), 300'000, 2'000);
  way.take(INT64_MAX);
  EXPECT_GT(way.wants(), 0u);
}

}  // namespace
}  // namespace mirage::test
