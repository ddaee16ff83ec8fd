// Scheduler: the window, one ask per instance, and asks that never come back.
#include "client/ask/scheduler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>

#include "protocol/base/limits.h"
#include "protocol/impostor/tile_key.h"
#include "tests/support/core_scene.h"
#include "wire_generated.h"

namespace mirage::test {
namespace {

constexpr double kFirstWindowBytes = 256 * 1024;
// Expected for size class 6, before any arrived.
constexpr double kTileBytes = 160 + 0.6 * 128 * 128;
constexpr std::uint64_t kCreditAhead = 64u << 20;

class CoreScheduler : public ::testing::Test {
 protected:
  CoreScheduler() : scene(make_scene(std::vector<Placed>(2000), {})) { greet(scheduler); }
  /// Welcomes with a server that is fast enough.
  static void greet(Scheduler& scheduler) { scheduler.note_welcome(0, 0, 50); }
  static std::vector<TileNeed> needs(std::uint32_t count, std::uint8_t size_class,
                                     std::uint32_t first = 0) {
    std::vector<TileNeed> out(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      out[i].instance = first + i;
      out[i].size_class = size_class;
      out[i].gain = 1000.0 - i;
    }
    return out;
  }
  std::optional<wire::RequestBatchT> plan(const std::vector<TileNeed>& wanted, std::int64_t now,
                                          const std::vector<AssetNeed>& assets = {},
                                          std::uint32_t lighting = 0) {
    scheduler.note_frame(now);
    return scheduler.plan(scene, wanted, assets, lighting, now);
  }
  static AssetNeed mesh(std::uint32_t object, double bytes = 1000, double gain = 10) {
    return {{AssetId::Kind::kMesh, object, 0}, gain, bytes};
  }
  const SceneView scene;
  Scheduler scheduler;
};

TEST_F(CoreScheduler, WindowLimitsWhatIsUnderWay) {
  // The last one may cross the line.
  const auto expected = static_cast<std::size_t>(kFirstWindowBytes / kTileBytes) + 1;
  const auto batch = plan(needs(1000, 6), 0);
  ASSERT_TRUE(batch);
  EXPECT_EQ(batch->asks.size(), expected);
  EXPECT_EQ(scheduler.in_flight(), expected);
  EXPECT_FALSE(plan(needs(1000, 6), 1000)) << "full, and nothing to say";
  // Largest gain first.
  for (std::size_t i = 0; i < expected; ++i) EXPECT_EQ(batch->asks[i].instance(), i);
  Scheduler fresh;
  greet(fresh);
  EXPECT_EQ(fresh.plan(scene, needs(1000, 12), {}, 0, 0)->asks.size(), 2u)
      << "two large ones fill it, but are never too large to be asked for";
}

TEST_F(CoreScheduler, WindowFollowsTheRateAndLastsFromFrameToFrame) {
  // Tiles of 8 kB, one every 2 ms after 18 ms on the way: 4 MB/s.
  for (const std::int64_t frame_us : {10'000, 25'000, 100'000, 400'000}) {
    Scheduler fresh;
    greet(fresh);
    std::deque<std::pair<std::uint32_t, std::int64_t>> coming;
    std::int64_t link_free = 0;
    for (std::int64_t now = 0; now < 100 * frame_us; now += frame_us) {
      while (!coming.empty() && coming.front().second <= now) {
        ASSERT_TRUE(fresh.finish(coming.front().first, 8000, {}, coming.front().second));
        coming.pop_front();
      }
      fresh.note_frame(now);
      const auto batch = fresh.plan(scene, needs(1500, 4), {}, 0, now);
      if (!batch) continue;
      for (const wire::Ask& ask : batch->asks) {
        link_free = std::max(now + 18'000, link_free) + 2'000;
        coming.emplace_back(ask.request_id(), link_free);
      }
    }
    const auto slack = std::clamp<std::int64_t>(frame_us + frame_us / 4, 25'000, 500'000);
    const double window = 4.0 * (20'000.0 + static_cast<double>(slack));
    EXPECT_NEAR(static_cast<double>(fresh.in_flight()), window / 8000, 0.15 * window / 8000)
        << frame_us;
  }
}

TEST_F(CoreScheduler, AQuietWhileDoesNotCloseTheWindow) {
  const auto first = plan(needs(1, 4), 0);
  std::int64_t now = 100'000;
  ASSERT_TRUE(scheduler.finish(first->asks[0].request_id(), 300, {}, now));
  for (std::uint32_t i = 1; i < 20; ++i) {  // small tiles, few of them, ten a second
    const auto batch = plan(needs(1, 4, i), now);
    ASSERT_TRUE(batch);
    now += 100'000;
    ASSERT_TRUE(scheduler.finish(batch->asks[0].request_id(), 300, {}, now));
  }
  const auto burst = plan(needs(100, 4, 100), now);
  ASSERT_TRUE(burst);
  EXPECT_GT(burst->asks.size(), 40u);
}

// A first image counts as waiting only while asking for it waits.
TEST_F(CoreScheduler, WhatIsUnderWayDoesNotWait) {
  std::vector<TileNeed> wanted = needs(2, 12);
  for (TileNeed& need : wanted) need.first = true;
  ASSERT_TRUE(plan(wanted, 0)) << "two large tiles fill the window";
  EXPECT_FALSE(scheduler.first_waits());
  EXPECT_FALSE(plan(wanted, 500'000));
  EXPECT_FALSE(scheduler.first_waits());
  wanted.push_back(needs(1, 12, 2).front());
  EXPECT_FALSE(plan(wanted, 510'000));
  EXPECT_FALSE(scheduler.first_waits()) << "it has an image";
  wanted.back().first = true;
  EXPECT_FALSE(plan(wanted, 520'000));
  EXPECT_TRUE(scheduler.first_waits());
}

TEST_F(CoreScheduler, GeometryUnderWayDoesNotWait) {
  const AssetNeed large = mesh(0, 10 * kFirstWindowBytes);
  AssetNeed other = mesh(1);
  const AssetNeed too = mesh(2, 10 * kFirstWindowBytes);
  ASSERT_TRUE(plan({}, 0, {large, too}));
  EXPECT_FALSE(plan({}, 500'000, {large, too, other})) << "two fill the window";
  EXPECT_FALSE(scheduler.first_waits());
  other.first = true;
  EXPECT_FALSE(plan({}, 510'000, {large, too, other}));
  EXPECT_TRUE(scheduler.first_waits());
}

// Asks wait in both cases. Only in one of them they wait for the link, and tau rises only for that.
TEST_F(CoreScheduler, WhatWaitsAtTheServerDoesNotFillTheLink) {
  for (const bool at_server : {false, true}) {
    Scheduler fresh;
    std::deque<std::pair<std::uint32_t, std::int64_t>> under_way;  // ask, when it was sent
    double saturated = 0;
    for (std::int64_t now = 0; now < 3'000'000; now += 10'000) {
      if (now >= 100'000 && now % 20'000 == 0 && !under_way.empty()) {
        const auto [id, sent] = under_way.front();
        const std::int64_t server = at_server ? now - sent - 10'000 : 0;
        under_way.pop_front();
        fresh.finish(id, 10'000, {std::max<std::int64_t>(server, 0), 5000}, now);
      }
      const auto batch = fresh.plan(scene, needs(2000, 6), {}, 0, now);
      for (std::size_t i = 0; batch && i < batch->asks.size(); ++i) {
        under_way.emplace_back(batch->asks[i].request_id(), now);
      }
      saturated = std::max(saturated, fresh.saturated_s(now));
    }
    if (at_server) {
      EXPECT_EQ(saturated, 0);
    } else {
      EXPECT_GE(saturated, 0.5);
    }
  }
}

// Nothing arrived, whatever was expected: a refusal says nothing about the link.
TEST_F(CoreScheduler, RefusedGeometryDoesNotOpenTheWindow) {
  std::vector<AssetNeed> wanted;
  for (std::uint32_t i = 0; i < 20; ++i) wanted.push_back(mesh(i, 10'000));
  const auto batch = plan({}, 0, wanted);
  ASSERT_TRUE(batch);
  ASSERT_EQ(batch->mesh_asks.size(), 20u);
  for (const wire::MeshAsk& one : batch->mesh_asks) scheduler.refuse(one.request_id(), 1000);
  const auto next = plan(needs(1000, 6), 2000);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->asks.size(), static_cast<std::size_t>(kFirstWindowBytes / kTileBytes) + 1);
}

TEST_F(CoreScheduler, OneAskPerInstance) {
  const auto first = plan(needs(5, 2), 0);
  ASSERT_TRUE(first);
  ASSERT_EQ(first->asks.size(), 5u);
  EXPECT_FALSE(plan(needs(5, 2), 10'000));
  const auto more = plan(needs(7, 2), 20'000);
  ASSERT_TRUE(more);
  std::set<std::uint32_t> instances;
  for (const wire::Ask& a : more->asks) instances.insert(a.instance());
  EXPECT_EQ(instances, (std::set<std::uint32_t>{5, 6}));
  ASSERT_TRUE(scheduler.finish(first->asks[3].request_id(), 1000, {}, 30'000));
  const auto again = plan(needs(7, 2), 40'000);
  ASSERT_TRUE(again);
  ASSERT_EQ(again->asks.size(), 1u);
  EXPECT_EQ(again->asks[0].instance(), 3u);
  EXPECT_NE(again->asks[0].request_id(), first->asks[3].request_id());
}

TEST_F(CoreScheduler, CancelsWhatIsNoLongerNeeded) {
  const auto first = plan(needs(4, 2), 0);
  ASSERT_TRUE(first);
  EXPECT_FALSE(plan(needs(2, 2), 10'000)) << "it may be needed again in the next frame";
  const auto second = plan(needs(2, 2), 120'000);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->cancels,
            (std::vector<std::uint32_t>{first->asks[2].request_id(), first->asks[3].request_id()}));
  EXPECT_EQ(scheduler.in_flight(), 2u);
  EXPECT_FALSE(scheduler.finish(first->asks[2].request_id(), 1000, {}, 20'000)) << "cancelled";
  EXPECT_TRUE(scheduler.finish(first->asks[0].request_id(), 1000, {}, 20'000));
  EXPECT_FALSE(scheduler.finish(first->asks[0].request_id(), 1000, {}, 20'000)) << "answered twice";
  EXPECT_FALSE(scheduler.finish(12345, 1000, {}, 20'000)) << "never asked";
}

// A reply sent before the server heard of the cancel still takes its place on the link.
TEST_F(CoreScheduler, CancelledCountUntilTheyAreDue) {
  std::int64_t now = 0;
  for (std::uint32_t i = 0; i < 20; ++i) {  // round trips of 1 s
    const auto batch = plan(needs(1, 4, i), now);
    for (int frame = 0; frame < 100; ++frame) plan(needs(1, 4, i), now += 10'000);
    scheduler.finish(batch->asks[0].request_id(), 3000, {}, now);
  }
  const auto full = plan(needs(1000, 6), now);
  ASSERT_TRUE(full);
  EXPECT_FALSE(plan(needs(1000, 4, 1000), now + 1'000'000)) << "patience is a trip";
  const auto cancels = plan(needs(1000, 4, 1000), now + 1'030'000);
  ASSERT_TRUE(cancels);
  EXPECT_EQ(cancels->cancels.size(), full->asks.size());
  EXPECT_EQ(cancels->asks.size(), 0u) << "they may still come";
  EXPECT_FALSE(plan(needs(1000, 4, 1000), now + 2'500'000)) << "half a trip longer than one";
  const auto rest = plan(needs(1000, 4, 1000), now + 2'600'000);
  ASSERT_TRUE(rest);
  EXPECT_GT(rest->asks.size(), full->asks.size() / 2) << "and then they do not come any more";
}

// A slow server has sent nothing of what waits there, and will not: the place is free after a trip.
TEST_F(CoreScheduler, CancelledAtASlowServerAreForgottenAfterATrip) {
  std::deque<std::uint32_t> under_way;
  std::int64_t now = 0;
  for (std::uint32_t i = 0; i < 200; ++i, now += 10'000) {  // 0.9 s of a second at the server
    if (const auto batch = plan(needs(i + 1, 2), now)) {
      for (const wire::Ask& ask : batch->asks) under_way.push_back(ask.request_id());
    }
    if (i < 100 || under_way.empty()) continue;
    scheduler.finish(under_way.front(), 1000, {900'000, 5000}, now);
    under_way.pop_front();
  }
  now += 3'000'000;
  for (const std::uint32_t id : under_way) scheduler.finish(id, 1000, {900'000, 5000}, now);
  const auto full = plan(needs(1000, 10), now);
  ASSERT_TRUE(full);
  const auto others = needs(1000, 4, 1000);
  std::optional<wire::RequestBatchT> cancels, rest;
  while (!cancels) cancels = plan(others, now += 10'000);
  ASSERT_EQ(cancels->cancels.size(), full->asks.size());
  ASSERT_EQ(cancels->asks.size(), 0u) << "they may still come";
  const std::int64_t cancelled = now;
  while (!rest && now < cancelled + 5'000'000) rest = plan(others, now += 10'000);
  EXPECT_LE(now - cancelled, 1'000'000);
}

// If asks were cancelled, a light that changes faster than tiles arrive would never show any.
TEST_F(CoreScheduler, NewLightLetsWhatIsUnderWayArrive) {
  const auto first = plan(needs(2, 2), 0, {}, 1);
  EXPECT_FALSE(plan(needs(2, 2), 10'000, {}, 2));
  const auto ask = scheduler.finish(first->asks[1].request_id(), 1000, {}, 20'000);
  ASSERT_TRUE(ask);
  const auto second = plan(needs(2, 2), 20'000, {}, 2);
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->cancels.empty());
  ASSERT_EQ(second->asks.size(), 1u);
  EXPECT_EQ(second->asks[0].instance(), 1u);
  EXPECT_EQ(second->lighting_id, 2u);
}

TEST_F(CoreScheduler, RefusedPausesThenAsksAgain) {
  const auto first = plan(needs(1, 2), 0);
  scheduler.refuse(first->asks[0].request_id(), 100'000);
  EXPECT_EQ(scheduler.in_flight(), 0u);
  EXPECT_FALSE(plan(needs(1, 2), 349'999));
  const auto again = plan(needs(1, 2), 350'000);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->asks.size(), 1u);
  scheduler.refuse(4711, 0);  // never asked for
}

TEST_F(CoreScheduler, LostAsksAreGivenUp) {
  const auto first = plan(needs(1, 2), 0);
  EXPECT_FALSE(plan(needs(1, 2), 5'000'000));
  const auto again = plan(needs(1, 2), 5'000'001);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->cancels, std::vector<std::uint32_t>{first->asks[0].request_id()});
  EXPECT_EQ(again->asks.size(), 1u);
}

TEST_F(CoreScheduler, CreditGrowsWithWhatHasArrived) {
  const auto first = plan(needs(1, 2), 0);
  EXPECT_EQ(first->credit_bytes, kCreditAhead);
  scheduler.finish(first->asks[0].request_id(), 123'456, {}, 10'000);
  EXPECT_EQ(plan(needs(1, 2), 20'000)->credit_bytes, kCreditAhead + 123'456);
  // A cancelled tile was sent nevertheless.
  scheduler.finish(999, 1'000, {}, 30'000);
  EXPECT_EQ(plan(needs(2, 2), 40'000)->credit_bytes, kCreditAhead + 124'456);
  scheduler.reset();
  EXPECT_EQ(plan(needs(3, 2), 50'000)->credit_bytes, kCreditAhead) << "a new connection";
}

TEST_F(CoreScheduler, GeometryIsAskedForOnce) {
  const AssetNeed image{{AssetId::Kind::kImage, 3, 1}, 10, 500};
  const auto first = plan({}, 0, {mesh(3), mesh(5), image});
  ASSERT_TRUE(first);
  ASSERT_EQ(first->mesh_asks.size(), 2u);
  EXPECT_EQ(first->mesh_asks[1].object(), 5u);
  ASSERT_EQ(first->image_asks.size(), 1u);
  EXPECT_EQ(first->image_asks[0].level(), 1);
  EXPECT_FALSE(plan({}, 10, {mesh(3), mesh(5), image}));
  const auto arrived = scheduler.finish_asset(first->mesh_asks[0].request_id(), 900, 20);
  ASSERT_TRUE(arrived);
  EXPECT_EQ(arrived->id.index, 3u);
  EXPECT_FALSE(scheduler.finish_asset(first->mesh_asks[0].request_id(), 900, 20)) << "twice";
  scheduler.refuse(first->mesh_asks[1].request_id(), 20);
  const auto second = plan({}, 30, {mesh(3), mesh(5)});
  ASSERT_TRUE(second);
  ASSERT_EQ(second->mesh_asks.size(), 1u) << "what was refused pauses";
  EXPECT_EQ(second->mesh_asks[0].object(), 3u);
  EXPECT_EQ(plan({}, 5'000'030, {mesh(5)})->mesh_asks.size(), 1u);
  scheduler.reset();
  EXPECT_EQ(plan({}, 40, {mesh(3), mesh(5)})->mesh_asks.size(), 2u);
}

TEST_F(CoreScheduler, WhatIsWorthMoreAByteComesFirst) {
  // Tiles are worth 1000 and less. Meshes take 0.4 of their bytes, and are worth 450 and less.
  std::vector<AssetNeed> meshes;
  for (std::uint32_t i = 0; i < 10; ++i) meshes.push_back(mesh(i, 4000, 450.0 - i));
  const auto batch = plan(needs(1000, 6), 0, meshes);
  ASSERT_TRUE(batch);
  ASSERT_EQ(batch->mesh_asks.size(), 10u)
      << "a byte of the least is worth more than one of any tile";
  const double left = kFirstWindowBytes - 10 * 4000;
  EXPECT_NEAR(static_cast<double>(batch->asks.size()), left / kTileBytes, 1);
  EXPECT_GT(batch->asks[0].error_px(), batch->asks[1].error_px()) << "the server ranks them alike";
  EXPECT_FALSE(plan(needs(1000, 6), 1000, meshes)) << "full for both";
  Scheduler fresh;
  greet(fresh);
  for (AssetNeed& need : meshes) need.gain /= 10;
  EXPECT_TRUE(fresh.plan(scene, needs(1000, 6), meshes, 0, 0)->mesh_asks.empty())
      << "and worth less than any of the tiles there is room for";
}

TEST_F(CoreScheduler, OneLargeMeshLeavesTilesHalfTheWindow) {
  const auto first = plan({}, 0, {mesh(0, 10 * kFirstWindowBytes)});
  ASSERT_EQ(first->mesh_asks.size(), 1u);
  const auto second = plan(needs(1000, 6), 10, {mesh(0), mesh(1, 1000, 0.1)});
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->mesh_asks.empty());
  const double tiles = static_cast<double>(second->asks.size()) * kTileBytes;
  EXPECT_NEAR(tiles, 0.5 * kFirstWindowBytes, kTileBytes);
}

// A server that takes its time with tiles must not keep geometry from an idle link.
TEST_F(CoreScheduler, ASlowServerLeavesTheLinkToGeometry) {
  std::vector<AssetNeed> meshes;
  for (std::uint32_t i = 0; i < 500; ++i) meshes.push_back(mesh(i, 4000, 1));
  Scheduler slow;
  slow.note_welcome(0, 0, 100'000);  // the time it takes for a tile
  const auto batch = slow.plan(scene, needs(1000, 6), meshes, 0, 0);
  ASSERT_TRUE(batch);
  EXPECT_LE(batch->asks.size(), 4u);
  EXPECT_GE(static_cast<double>(batch->mesh_asks.size()) * 4000, 0.8 * kFirstWindowBytes);
}

TEST_F(CoreScheduler, SurroundingsComeBeforeTiles) {
  std::vector<AssetNeed> meshes;
  for (std::uint32_t i = 0; i < 100; ++i) meshes.push_back(mesh(i, 4000, HUGE_VAL));
  const auto batch = plan(needs(1000, 6), 0, meshes);
  ASSERT_TRUE(batch);
  EXPECT_EQ(batch->mesh_asks.size(), 66u) << "the whole window";
}

// A reply of 8 MB that arrives a second after its ask means 8 MB a second, not 8 MB in an instant.
TEST_F(CoreScheduler, ALargeReplyIsNoBurst) {
  std::int64_t now = 0;
  for (std::uint32_t i = 0; i < 10; ++i) {
    const auto batch = plan(needs(1, 4, i), now);
    ASSERT_TRUE(batch);
    scheduler.finish(batch->asks[0].request_id(), 3000, {}, now + 100'000);
    now += 100'000;
  }
  const auto asked = plan({}, now, {mesh(0, 8e6)});
  ASSERT_TRUE(asked);
  now += 1'000'000;
  ASSERT_TRUE(scheduler.finish_asset(asked->mesh_asks[0].request_id(), 8'000'000, now));
  for (std::uint32_t i = 0; i < 10; ++i) scheduler.finish(9999, 100, {}, now);
  ASSERT_TRUE(plan(needs(1500, 8), now)) << "what the first window allows; the rest waits";
  ASSERT_TRUE(plan(needs(1500, 8), now)) << "and as it waits the window grows";
  // Ten round trips of 0.1 s are no queue: the rest of a second is the reply's own time on the
  // link.
  const double window = 8e6 / 0.9 * (0.1 + 0.025);
  const double each = 160 + 0.384 * 256 * 256;
  EXPECT_NEAR(static_cast<double>(scheduler.in_flight()), window / each, 0.05 * window / each);
}

TEST_F(CoreScheduler, BatchesKeepTheProtocolsLimits) {
  std::vector<AssetNeed> all;
  for (std::uint32_t i = 0; i < 3000; ++i) all.push_back(mesh(i, 1));
  std::set<std::uint32_t> asked;
  for (int i = 0; i < 4; ++i) {
    const auto batch = plan({}, i, all);
    if (!batch) break;
    EXPECT_LE(batch->mesh_asks.size(), limits::kMaxAsksPerBatch);
    for (const wire::MeshAsk& ask : batch->mesh_asks) asked.insert(ask.object());
  }
  EXPECT_EQ(asked.size(), all.size());
}

TEST_F(CoreScheduler, NothingUnderWayLeavesTheWholeWindow) {
  // Tiles compress better and worse by turns, so the expectation changes while asks are under way.
  std::int64_t now = 0;
  for (int round = 0; round < 210; ++round) {
    const auto batch = plan(needs(20, 8), now);
    ASSERT_TRUE(batch) << "round " << round;
    now += 50'000;
    for (const wire::Ask& a : batch->asks) {
      scheduler.finish(a.request_id(), (round / 10) % 2 == 0 ? 5000 : 60'000, {}, now);
    }
    ASSERT_EQ(scheduler.in_flight(), 0u);
    now += 1'500'000;  // the measured rate is forgotten
  }
  // The expectation is now 500 bytes for 256 x 256 texels, and the first window is free again.
  now += 2'000'000;
  const auto batch = plan(needs(1024, 10), now);
  ASSERT_TRUE(batch);
  const double expected = kFirstWindowBytes / (160 + 5000.0 / 65'536 * 512 * 512 / std::sqrt(2.0));
  EXPECT_NEAR(static_cast<double>(batch->asks.size()), expected, 0.05 * expected);
}

TEST_F(CoreScheduler, RoundTripIsTheMedian) {
  EXPECT_EQ(scheduler.round_trip_us(), 0);
  std::int64_t now = 0;
  for (int i = 0; i < 33; ++i) {
    const auto batch = plan(needs(1, 2), now);
    const std::int64_t trip = i % 8 == 0 ? 900'000 : 100'000 + i;
    scheduler.finish(batch->asks[0].request_id(), 500, {}, now + trip);
    now += 1'000'000;
  }
  EXPECT_NEAR(static_cast<double>(scheduler.round_trip_us()), 100'016, 20);
}

}  // namespace
}  // namespace mirage::test
