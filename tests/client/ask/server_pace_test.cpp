// Server pace: how many tiles may be under way at a server that makes one after the other.
#include "client/ask/server_pace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "client/link/busy_time.h"

namespace mirage {
namespace {

/// A server that takes `tile_us` for a tile, at a distance of `way_us`, and a client that always
/// wants more tiles.
struct Shop {
  Shop(std::int64_t tile, std::int64_t way) : tile_us(tile), way_us(way) {}
  void run(std::int64_t until_us) {
    for (; now_us < until_us; now_us += step_us) {
      while (!asked.empty() && asked.front().done_us + way_us / 2 <= now_us) {
        const Ask& ask = asked.front();
        pace.tile_arrived({ask.sent_us, ask.done_us + way_us / 2,
                           ask.done_us - ask.sent_us - way_us / 2, 1000, 1000, ask.under_way});
        asked.pop_front();
        ++made;
      }
      const std::size_t most = std::min<std::size_t>(pace.limit(way_us, 50'000), 500);
      while (asked.size() < most) {
        free_us = std::max(free_us, now_us + way_us / 2) + tile_us;
        asked.push_back({now_us, free_us, asked.size() + 1});
      }
      longest_us = std::max(longest_us, free_us - now_us - way_us / 2);
    }
  }

  struct Ask {
    std::int64_t sent_us, done_us;
    std::size_t under_way;
  };
  static constexpr std::int64_t step_us = 16'000;
  std::int64_t tile_us, way_us;
  ServerPace pace;
  std::deque<Ask> asked;
  std::int64_t now_us = 0, free_us = 0, longest_us = 0;
  int made = 0;
};

TEST(CoreServerPace, ASlowServerIsKeptBusyAndItsQueueShort) {
  for (const std::int64_t way : {20'000, 100'000, 400'000}) {
    Shop shop(20'000, way);
    shop.run(6'000'000);
    shop.longest_us = 0;
    const int before = shop.made;
    shop.run(12'000'000);
    EXPECT_GE(shop.made - before, 0.9 * 6e6 / 20'000) << way;
    EXPECT_LE(shop.longest_us, 180'000) << way;
  }
}

TEST(CoreServerPace, AFastServerLimitsNothing) {
  Shop shop(200, 40'000);
  shop.run(2'000'000);
  EXPECT_GE(shop.pace.limit(40'000, 50'000), 300u);
}

TEST(CoreServerPace, AServerThatGetsFasterIsFollowed) {
  Shop shop(100'000, 40'000);
  shop.run(8'000'000);
  EXPECT_LE(shop.pace.limit(40'000, 50'000), 6u);
  shop.tile_us = 1'000;
  shop.run(10'000'000);
  const int before = shop.made;
  shop.run(11'000'000);
  EXPECT_GE(shop.made - before, 500);
}

TEST(CoreServerPace, TimesThatCannotBeAreTaken) {
  ServerPace pace;
  for (int i = 0; i < 20; ++i) pace.tile_arrived({5, 0, INT64_MAX, 0, 0, 0});
  EXPECT_GE(pace.limit(0, 50'000), 1u);
  for (int i = 0; i < 20; ++i) pace.tile_arrived({0, INT64_MAX, -7, 0, 0, SIZE_MAX});
  EXPECT_GE(pace.limit(0, 50'000), 1u);
  for (const std::int64_t tile_us : {std::int64_t{-1}, INT64_MAX}) {
    ServerPace told;
    told.expect(tile_us);
    EXPECT_GE(told.limit(100'000, 50'000), 1u);
  }
}

TEST(CoreServerPace, BeforeTheFirstReplyTheServersWordCounts) {
  ServerPace pace;
  EXPECT_EQ(pace.limit(100'000, 50'000), 30u) << "5 ms a tile where it has none";
  pace.expect(20'000);
  EXPECT_EQ(pace.limit(100'000, 50'000), 7u);
  pace.expect(500);
  EXPECT_EQ(pace.limit(100'000, 50'000), 300u);
}

// The server takes the worst ask first, so some replies overtake a queue that exists nevertheless.
TEST(CoreServerPace, WhatOvertakesTheQueueMakesTheServerNoFaster) {
  ServerPace pace;
  std::int64_t done_us = 0;
  for (int i = 0; i < 40; ++i) {
    done_us += 10'000;
    const std::int64_t server_us = i % 4 == 0 ? 12'000 : 300'000;
    const std::int64_t sent_us = done_us - server_us;
    pace.tile_arrived({sent_us, done_us + 50'000, server_us, 1000, 1000, 60});
  }
  EXPECT_NEAR(static_cast<double>(pace.limit(50'000, 100'000)), 15, 1) << "100 a second";
}

TEST(CoreBusyTime, SharesOfASpan) {
  BusyTime busy;
  busy.add(0, 100);
  busy.add(150, 150);
  busy.add(200, 300);
  EXPECT_NEAR(busy.share(0, 400), 0.5, 1e-12);
  EXPECT_NEAR(busy.share(50, 250), 0.5, 1e-12);
  EXPECT_NEAR(busy.share(250, 300), 1, 1e-12);
  EXPECT_NEAR(busy.share(300, 500), 0, 1e-12);
  EXPECT_EQ(busy.share(500, 500), 0);
}

}  // namespace
}  // namespace mirage
