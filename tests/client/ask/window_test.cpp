// Ask window: how much may be under way, on a model of a link with a queue (numerics.md section 4).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <vector>

#include "client/ask/ask_window.h"

namespace mirage {
namespace {

constexpr std::size_t kTile = 8000;
constexpr std::int64_t kStepUs = 5'000;

/// Runs a frame; returns the window.
double frame(AskWindow& window, std::int64_t now_us, std::int64_t held_back_us, bool idle) {
  window.frame_began(now_us);
  return window.update(now_us, held_back_us, idle);
}

/// A client that always wants more than the link carries.
struct Plant {
  double rate_mbps = 20;
  std::int64_t rtt_us = 50'000;
  bool waits = true;  ///< false: the client never wants more than fits

  void run(double seconds) {
    const std::int64_t end = now_us + std::llround(seconds * 1e6);
    for (; now_us < end; now_us += kStepUs) {
      while (!under_way.empty() && under_way.front().arrives_us <= now_us) {
        const Reply& reply = under_way.front();
        window.tile_arrived({reply.sent_us, reply.arrives_us, 0, kTile, kTile});
        under_way.pop_front();
        received += kTile;
      }
      const std::int64_t waited_us = waits ? std::max<std::int64_t>(now_us - began_us, 1) : 0;
      const double bytes = frame(window, now_us, waited_us, under_way.empty());
      while (static_cast<double>(under_way.size() * kTile) < bytes) {
        const auto cost = static_cast<std::int64_t>(8.0 * kTile / rate_mbps);
        free_us = std::max(free_us, now_us + rtt_us / 2) + cost;
        const std::int64_t last = under_way.empty() ? 0 : under_way.back().arrives_us;
        under_way.push_back({now_us, std::max(free_us + rtt_us / 2, last)});
      }
      history.push_back(static_cast<double>(under_way.size() * kTile));
    }
  }
  /// Returns the least and most bytes under way in the last `seconds`.
  std::pair<double, double> range(double seconds) const {
    const auto n = static_cast<std::ptrdiff_t>(seconds * 1e6 / kStepUs);
    const auto [low, high] = std::minmax_element(history.end() - n, history.end());
    return {*low, *high};
  }
  double bound() const {
    // Two tiles are added: what fits is asked for whole, and a tile's own time on the link is no
    // queue.
    return rate_mbps * 0.125 * static_cast<double>(rtt_us + 50'000) + 2.0 * kTile;
  }

  struct Reply {
    std::int64_t sent_us, arrives_us;
  };
  AskWindow window;
  std::deque<Reply> under_way;
  std::vector<double> history;
  std::int64_t now_us = 0, began_us = 0, free_us = 0;
  std::size_t received = 0;
};

TEST(CoreWindow, SettlesAtTheBoundAndFillsTheLink) {
  for (const double rate : {5.0, 20.0, 100.0}) {
    for (const std::int64_t rtt : {10'000, 50'000, 200'000}) {
      Plant plant;
      plant.rate_mbps = rate;
      plant.rtt_us = rtt;
      plant.run(6);
      const std::size_t before = plant.received;
      plant.run(10);
      const double used = static_cast<double>(plant.received - before) * 8e-6 / 10 / rate;
      EXPECT_LE(plant.range(10).second, plant.bound()) << rate << " Mbit/s, " << rtt << " us";
      EXPECT_GE(used, 0.9) << rate << " Mbit/s, " << rtt << " us";
    }
  }
}

TEST(CoreWindow, FollowsASlowerLinkAndAFasterOne) {
  Plant plant;
  plant.run(6);
  plant.rate_mbps = 4;
  plant.run(2);
  plant.history.clear();
  plant.run(4);
  EXPECT_LE(plant.range(4).second, plant.bound());
  plant.rate_mbps = 40;
  plant.run(6);
  const std::size_t before = plant.received;
  plant.run(5);
  EXPECT_GE(static_cast<double>(plant.received - before) * 8e-6 / 5, 0.85 * 40);
}

TEST(CoreWindow, ALongerRoundTripIsFoundOut) {
  Plant plant;
  plant.rate_mbps = 10;
  plant.rtt_us = 20'000;
  plant.run(8);
  plant.rtt_us = 400'000;
  plant.run(20);
  const std::size_t before = plant.received;
  plant.run(20);
  EXPECT_GE(static_cast<double>(plant.received - before) * 8e-6 / 20, 0.7 * 10);
  EXPECT_LE(plant.range(20).second, plant.bound());
}

// The trip is longer than any queue that the window allows, so this does not take a whole period.
TEST(CoreWindow, AFarLongerRoundTripIsFoundOutInSeconds) {
  Plant plant;
  plant.rtt_us = 20'000;
  plant.run(7);
  plant.rtt_us = 400'000;
  plant.run(4);
  const std::size_t before = plant.received;
  plant.run(3);
  EXPECT_GE(static_cast<double>(plant.received - before) * 8e-6 / 3, 0.8 * plant.rate_mbps);
}

TEST(CoreWindow, AHundredfoldRoundTripKeepsTheBound) {
  Plant plant;
  plant.rate_mbps = 2;
  plant.rtt_us = 20'000;
  plant.run(6);
  plant.rtt_us = 2'000'000;
  plant.run(30);
  const std::size_t before = plant.received;
  plant.run(60);
  EXPECT_LE(plant.range(60).second, plant.bound());
  EXPECT_GE(static_cast<double>(plant.received - before) * 8e-6 / 60, 0.8 * 2);
}

// All replies may arrive after a period that had only slow trips. The next trip tells whether a
// queue or a longer way made them slow.
TEST(CoreWindow, DrainedAWayIsToldFromAQueue) {
  for (const std::int64_t found : {50'000, 150'000}) {
    AskWindow window;
    std::int64_t now = 0, trip = 50'000;
    double last = 0;
    const auto step = [&] {
      now += 2'000;
      window.tile_arrived({now - trip, now, 0, 2'000, 2'000});  // 1 MB/s
      last = window.update(now, now, false);
    };
    // The first did not wait for the one before it. The others did, so the link is busy.
    const auto first_step = [&] {
      trip -= 2'000;
      step();
      trip += 2'000;
    };
    first_step();
    while (now < 500'000) step();
    // The first window was more than the link carries.
    trip = 70'000;
    while (now < 2'000'000) step();
    trip = 50'000;
    while (now < 7'000'000) step();
    EXPECT_NEAR(last, 75'000, 3'000);
    for (trip = 150'000; now < 16'000'000 && last > 0;) {
      ASSERT_LE(last, 76'000) << "still a queue";
      step();
    }
    ASSERT_EQ(last, 0) << "drained";
    window.update(now, 1, true);  // everything has arrived
    trip = found;
    now += 200'000;
    first_step();
    for (int i = 0; i < 500; ++i) step();
    EXPECT_NEAR(last, static_cast<double>(found) + 25'000, 5'000);
  }
}

// Bursts with gaps: the link is as fast as within a burst.
TEST(CoreWindow, GapsSayNothingAboutTheLink) {
  AskWindow window;
  std::int64_t now = 0;
  for (int train = 0; train < 8; ++train) {
    const std::int64_t sent = now;
    for (; now < sent + 250'000; now += 10'000) {  // 10 kB in 10 ms: 1 MB/s
      if (now >= sent + 50'000) window.tile_arrived({sent, now, 0, 10'000, 10'000});
      window.update(now, 1, false);
    }
    now += 750'000;
  }
  EXPECT_NEAR(window.update(now - 750'000, 1, false), 0.95 * 75'000 - 10'000, 3'000);
}

// Replies that arrive at once may have waited together, so they tell no rate.
TEST(CoreWindow, ABurstAtMostDoublesIt) {
  AskWindow window;
  double before = 0;
  for (std::int64_t now = 0; now <= 4'000'000; now += 10'000) {  // a kB in 0.1 s, after 1 s
    if (now > 1'000'000 && now % 100'000 == 0) {
      window.tile_arrived({now - 1'000'000, now, 0, 1000, 1000});
    }
    before = window.update(now, 2'000'000, false);
  }
  for (int i = 0; i < 40; ++i) window.tile_arrived({3'000'000, 4'010'000, 0, 1000, 1000});
  EXPECT_LE(window.update(4'010'000, 2'000'000, false), std::max(before, 2 * 51'000.0));
}

TEST(CoreWindow, ASleepIsNoRate) {
  AskWindow window;
  EXPECT_EQ(window.update(0, 0, true), 256 * 1024);
  for (int i = 1; i <= 20; ++i) window.tile_arrived({i * 1000, i * 1000 + 50'000, 0, 1000, 1000});
  const std::int64_t hour = 3'600'000'000;
  EXPECT_LE(window.update(hour, 0, true), 256 * 1024);
  EXPECT_EQ(window.rate_mbps(), 0);
}

// The server makes a tile of 2 kB every 20 ms; the link carries each at once.
TEST(CoreWindow, TimeAtTheServerIsNotTheLinks) {
  for (const bool told : {true, false}) {
    AskWindow window;
    std::int64_t now = 0;
    double last = 0, least = 1e9;
    for (int i = 0; i < 400; ++i) {
      now += 20'000;
      const std::int64_t server = 20'000 * (1 + i % 20);  // twenty at a time
      window.tile_arrived({now - 60'000 - server, now, told ? server : 0, 2000, 2000});
      last = window.update(now, now, false);
      least = std::min(least, last);
    }
    if (told) {
      EXPECT_GE(least, 256 * 1024) << "nothing tells that the link is thin";
    } else {
      EXPECT_LE(least, 20'000) << "passes for the link's";
    }
  }
}

TEST(CoreWindow, TheOpeningTellsTheFirstWindow) {
  const auto first = [](std::int64_t page_us) {
    AskWindow window;
    window.welcomed(1'000'000, 100'000);
    for (int i = 1; i < 5; ++i) window.opening_arrived(1'000'000 + i * page_us, 60'000);
    return frame(window, 2'000'000, 0, true);
  };
  EXPECT_NEAR(first(10'000), 6.0 * 125'000, 1) << "6 MB/s for 125 ms";
  EXPECT_NEAR(first(60'000), 1.0 * 125'000, 1) << "1 MB/s";
  EXPECT_EQ(first(1'000'000), 64 * 1024) << "no less than that";
  EXPECT_EQ(first(0), 256 * 1024) << "all at once: nothing is known";
}

// Asks are sent once a frame, so what arrives between two frames is under way as well.
TEST(CoreWindow, TheFirstWindowHoldsAWholeFrame) {
  AskWindow window;
  window.welcomed(1'000'000, 100'000);
  for (int i = 1; i < 5; ++i) window.opening_arrived(1'000'000 + i * 10'000, 60'000);
  window.frame_began(1'040'000);
  EXPECT_NEAR(frame(window, 1'140'000, 0, true), 6.0 * (100'000 + 125'000), 1);
}

TEST(CoreWindow, AWelcomeTellsTheWay) {
  AskWindow window;
  EXPECT_EQ(window.round_trip_us(), 0);
  window.welcomed(1'000'000, 300'000);
  EXPECT_EQ(window.round_trip_us(), 300'000);
  window.tile_arrived({2'000'000, 2'080'000, 30'000, 1000, 1000});
  EXPECT_EQ(window.way_us(), 50'000) << "the shortest counts";
  window.welcomed(3'000'000, 10'000);
  EXPECT_EQ(window.way_us(), 50'000) << "and what tiles tell more than a greeting";
}

// Tiles that wait at a server are not on the link, and take no place from those that are.
TEST(CoreWindow, TilesAtTheServerAreOnTop) {
  const auto after = [](std::int64_t server_us) {
    AskWindow window;
    double last = 0;
    for (std::int64_t now = 0; now <= 4'000'000; now += 5'000) {  // a MB/s
      const std::int64_t trip = now < 500'000 ? 50'000 : 70'000;  // a queue from then on
      window.tile_arrived({now - trip - server_us, now, server_us, 5'000, 5'000});
      last = frame(window, now, 1'000'000, false);
    }
    return last;
  };
  EXPECT_NEAR(after(200'000) - after(0), 175'000, 10'000) << "but for what the slack holds";
}

}  // namespace
}  // namespace mirage
