// Tile queue: merging, order, turns, and every ask accounted for.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "protocol/base/limits.h"
#include "server/tile/tile_queue.h"

namespace mirage::test {
namespace {

using Admission = TileQueue::Admission;

TileKey key_of(std::uint32_t n, std::uint8_t size_class = 4) {
  TileKey key;
  key.object = n;
  key.size_class = size_class;
  return key;
}

class ServerQueue : public ::testing::Test {
 protected:
  Admission submit(SessionId session, std::uint32_t request, const TileKey& key, float error = 1,
                   std::int64_t deadline_us = 0) {
    const Waiter waiter{session, request, error, deadline_us};
    return queue.submit(key, tile_id(key), ObjectLighting{}, waiter);
  }
  /// Returns the objects of the next batch, at most `n` tiles, in order.
  std::vector<std::uint32_t> take(std::size_t n = 1000) {
    std::vector<std::uint32_t> out;
    const auto work = queue.take({[&](std::uint32_t) { return n-- > 0; }}, false);
    if (!work || !std::holds_alternative<std::vector<TileJob>>(*work)) return out;
    for (const TileJob& job : std::get<std::vector<TileJob>>(*work)) out.push_back(job.key.object);
    return out;
  }
  std::size_t finish(std::uint32_t object) { return queue.finish(tile_id(key_of(object))).size(); }

  VirtualClock clock;
  Counters counters;
  TileQueue queue{clock, counters};
};
using Objects = std::vector<std::uint32_t>;

TEST_F(ServerQueue, EqualKeysMergeIntoOneJobForBoth) {
  EXPECT_EQ(submit(1, 10, key_of(7)), Admission::kQueued);
  EXPECT_EQ(submit(2, 20, key_of(7)), Admission::kMerged);
  EXPECT_EQ(take(), Objects{7});
  EXPECT_EQ(submit(3, 30, key_of(7)), Admission::kMerged) << "while it renders";
  EXPECT_EQ(take(), Objects{});
  const std::vector<Waiter> waiters = queue.finish(tile_id(key_of(7)));
  std::set<std::pair<SessionId, std::uint32_t>> who;
  for (const Waiter& w : waiters) who.insert({w.session, w.request_id});
  EXPECT_EQ(who, (std::set<std::pair<SessionId, std::uint32_t>>{{1, 10}, {2, 20}, {3, 30}}));
  EXPECT_EQ(counters.tiles_merged, 2u);
  EXPECT_EQ(queue.length(), 0u);
  EXPECT_EQ(submit(1, 11, key_of(7)), Admission::kQueued) << "a finished key starts anew";
}

// A call between looking and waiting was missed; the tile then came with the next ask, or never.
TEST_F(ServerQueue, ACallToLookAgainIsNeverMissed) {
  submit(1, 1, key_of(1));
  std::thread caller;
  bool looked = false;
  TileQueue::Room room{[](std::uint32_t) { return true; }};
  room.slow_edge = 1;  // the tile is slow work
  room.slow = [&] {
    if (std::exchange(looked, true)) return true;
    caller = std::thread([&] { queue.look_again(); });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return false;  // there was no room yet
  };
  std::promise<bool> took;
  std::future<bool> done = took.get_future();
  std::thread taker([&] { took.set_value(queue.take(room, true).has_value()); });
  const bool in_time = done.wait_for(std::chrono::seconds(5)) == std::future_status::ready;
  if (!in_time) queue.close();
  taker.join();
  caller.join();
  EXPECT_TRUE(in_time);
}

TEST_F(ServerQueue, WorstErrorFirstEqualOnesInOrder) {
  submit(1, 1, key_of(1), 1);
  submit(1, 2, key_of(2), 5);
  submit(1, 3, key_of(3), 3);
  submit(1, 4, key_of(4), 5);
  EXPECT_EQ(take(), (Objects{2, 4, 3, 1}));
}

TEST_F(ServerQueue, ErrorsThatAreNoNumbersCountAsTheWorst) {
  submit(1, 1, key_of(1), 1e20f);
  submit(1, 2, key_of(2), std::numeric_limits<float>::quiet_NaN());
  submit(1, 3, key_of(3), -1);
  submit(1, 4, key_of(4), std::numeric_limits<float>::infinity());
  EXPECT_EQ(take(), (Objects{2, 3, 4, 1}));
}

TEST_F(ServerQueue, SessionsTakeTurns) {
  for (std::uint32_t i = 0; i < 100; ++i) submit(1, i, key_of(i), 1000);
  for (std::uint32_t i = 0; i < 3; ++i) submit(2, i, key_of(1000 + i), 1);
  const Objects order = take();
  ASSERT_EQ(order.size(), 103u);
  // However much the first session asks for, every second place is the other's.
  EXPECT_EQ(Objects(order.begin(), order.begin() + 6), (Objects{0, 1000, 1, 1001, 2, 1002}));
}

TEST_F(ServerQueue, TurnsGoOnAcrossBatches) {
  for (std::uint32_t i = 0; i < 10; ++i) {
    submit(1, i, key_of(i));
    submit(2, i, key_of(100 + i));
    submit(3, i, key_of(200 + i));
  }
  std::map<std::uint32_t, int> served;
  for (int batch = 0; batch < 9; ++batch) {
    const Objects one = take(1);
    ASSERT_EQ(one.size(), 1u);
    ++served[one[0] / 100];
  }
  EXPECT_EQ(served, (std::map<std::uint32_t, int>{{0, 3}, {1, 3}, {2, 3}}));
}

TEST_F(ServerQueue, CancelRemovesUnlessAnotherWaits) {
  submit(1, 1, key_of(1));
  submit(1, 2, key_of(2));
  submit(2, 9, key_of(2));
  queue.cancel(1, 1);
  queue.cancel(1, 2);
  queue.cancel(1, 77);  // never asked for
  queue.cancel(5, 1);   // never seen
  EXPECT_EQ(counters.tiles_cancelled, 2u);
  EXPECT_EQ(take(), Objects{2});
  const auto waiters = queue.finish(tile_id(key_of(2)));
  ASSERT_EQ(waiters.size(), 1u);
  EXPECT_EQ(waiters[0].session, 2u);
}

TEST_F(ServerQueue, CancelWhileRenderingDeliversToNobody) {
  submit(1, 1, key_of(1));
  EXPECT_EQ(take(), Objects{1});
  queue.cancel(1, 1);
  EXPECT_EQ(finish(1), 0u);
  EXPECT_EQ(queue.length(), 0u);
}

// A place that outlives its ask is memory that a client can make grow without end.
TEST_F(ServerQueue, RanksEndWithTheirAsks) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    submit(1, i, key_of(i));
    queue.cancel(1, i);
  }
  EXPECT_EQ(queue.ranks(), 0u) << "cancelled";
  submit(2, 1, key_of(1));
  submit(1, 1, key_of(1));
  EXPECT_EQ(queue.ranks(), 2u);
  EXPECT_EQ(take(), Objects{1});
  EXPECT_EQ(queue.ranks(), 0u) << "the second ask is served with the first";
  submit(3, 1, key_of(1));
  EXPECT_EQ(queue.ranks(), 0u) << "it is being rendered";
  submit(1, 2, key_of(2), 1, 1000);
  submit(2, 2, key_of(2), 1, 1000);
  clock.advance_to_us(1001);
  EXPECT_EQ(take(), Objects{});
  EXPECT_EQ(queue.ranks(), 0u) << "both were late";
  submit(1, 3, key_of(3));
  queue.remove_session(1);
  EXPECT_EQ(queue.ranks(), 0u) << "its session has gone";
}

TEST_F(ServerQueue, LateAsksAreDroppedAndReported) {
  submit(1, 1, key_of(1), 1, 1000);
  submit(1, 2, key_of(2), 1, 1000);
  submit(2, 3, key_of(2), 1, 5000);  // this one is still in time
  submit(1, 4, key_of(3), 1, 0);     // and this one has no deadline
  clock.advance_to_us(1000);
  EXPECT_TRUE(queue.take_late().empty());
  clock.advance_to_us(1001);
  const Objects order = take();
  EXPECT_EQ(std::multiset<std::uint32_t>(order.begin(), order.end()),
            (std::multiset<std::uint32_t>{2, 3}));
  const auto late = queue.take_late();
  ASSERT_EQ(late.size(), 1u);
  EXPECT_EQ(late[0].request_id, 1u);
  EXPECT_TRUE(queue.take_late().empty());
  EXPECT_EQ(counters.tiles_late, 1u);
}

TEST_F(ServerQueue, FullIsBusyPerSession) {
  for (std::uint32_t i = 0; i < limits::kMaxQueuedAsksPerClient; ++i) {
    ASSERT_EQ(submit(1, i, key_of(i)), Admission::kQueued);
  }
  EXPECT_EQ(submit(1, 100'000, key_of(1)), Admission::kBusy) << "merging takes a place, too";
  EXPECT_EQ(submit(2, 1, key_of(100'000)), Admission::kQueued);
  queue.cancel(1, 0);
  EXPECT_EQ(submit(1, 100'001, key_of(100'001)), Admission::kQueued);
}

TEST_F(ServerQueue, RepeatedRequestIdsDoNotPassTheBound) {
  for (std::uint32_t i = 0; i < 2 * limits::kMaxQueuedAsksPerClient; ++i) submit(1, 7, key_of(i));
  EXPECT_LE(queue.length(), limits::kMaxQueuedAsksPerClient);
  queue.remove_session(1);
  EXPECT_EQ(queue.length(), 0u);
  EXPECT_EQ(take(), Objects{});
}

TEST_F(ServerQueue, ReferencesAreOneASessionAndLeaveTilesTheirTurn) {
  for (std::uint32_t i = 0; i < 3; ++i) submit(1, i, key_of(i));
  for (const SessionId session : {1, 2, 3}) {
    EXPECT_TRUE(queue.submit(ReferenceJob{session, 7, {}}));
    EXPECT_FALSE(queue.submit(ReferenceJob{session, 8, {}})) << "it waits for one already";
  }
  std::string order;
  std::size_t n = 1;
  while (const auto work = queue.take({[&](std::uint32_t) { return n-- > 0; }}, false)) {
    order += std::holds_alternative<ReferenceJob>(*work) ? 'r' : 't';
    n = 1;
  }
  EXPECT_EQ(order, "rtrtrt");
}

// Turns are counted by work: a client that asks for large tiles waits, not those that ask for
// little.
TEST_F(ServerQueue, TurnsAreCountedByTexels) {
  for (std::uint32_t i = 0; i < 20; ++i) submit(1, i, key_of(100 + i, 12), 1000);
  take(1);  // one of them is under way
  for (std::uint32_t i = 0; i < 20; ++i) submit(2, i, key_of(200 + i, 4), 1);
  const Objects order = take();
  const auto is_small = [](std::uint32_t object) { return object >= 200; };
  const auto second_large = std::find_if_not(order.begin() + 1, order.end(), is_small);
  EXPECT_GE(std::count_if(order.begin(), second_large, is_small), 19);
}

TEST_F(ServerQueue, WhoWasAwayHasSavedUpNoTurns) {
  submit(2, 1, key_of(1));
  take();
  for (std::uint32_t i = 0; i < 50; ++i) submit(1, i, key_of(100 + i));
  take(40);
  for (std::uint32_t i = 2; i < 12; ++i) submit(2, i, key_of(200 + i));
  const Objects order = take(10);
  EXPECT_EQ(std::count_if(order.begin(), order.end(), [](auto object) { return object >= 200; }),
            5);
}

TEST_F(ServerQueue, TheWaitIsByTurnsToo) {
  EXPECT_EQ(queue.wait_us(1, 1000), 0);
  for (std::uint32_t i = 0; i < 10; ++i) submit(1, i, key_of(i));
  EXPECT_EQ(queue.wait_us(2, 1000), 1000) << "one of the other's comes before";
  EXPECT_EQ(queue.wait_us(1, 1000), 10'000);
  submit(2, 1, key_of(100));
  EXPECT_EQ(queue.wait_us(2, 1000), 3000);
}

TEST_F(ServerQueue, RemoveSessionTakesItsWorkAlong) {
  submit(1, 1, key_of(1));
  submit(1, 2, key_of(2));
  submit(2, 1, key_of(2));
  ASSERT_TRUE(queue.submit(ReferenceJob{1, 1, {}}));
  queue.remove_session(1);
  queue.remove_session(99);
  EXPECT_EQ(take(), Objects{2});
  EXPECT_EQ(finish(2), 1u);
  EXPECT_EQ(queue.length(), 0u);
}

TEST_F(ServerQueue, WhatDoesNotFitOpensTheNextBatch) {
  // Session 1 asks for something large, sessions 2 and 3 for a stream of small ones.
  submit(1, 1, key_of(1, 14), 1);
  for (std::uint32_t i = 0; i < 50; ++i) {
    submit(2, i, key_of(200 + i), 100);
    submit(3, i, key_of(300 + i), 100);
  }
  bool first = true;
  const auto small_page = [&](std::uint32_t edge) {  // a large one fits only an empty page
    const bool fits = edge < tile_edge(14) || first;
    first = false;
    return fits;
  };
  first = false;
  auto work = queue.take({small_page}, false);  // everything before the large one
  first = true;
  work = queue.take({small_page}, false);
  ASSERT_TRUE(work);
  EXPECT_EQ(std::get<std::vector<TileJob>>(*work)[0].key.object, 1u);
}

TEST_F(ServerQueue, WhatIsSlowComesAloneAndHoldsUpNobody) {
  constexpr std::uint8_t kLarge = 14;
  bool slow = true;
  TileQueue::Room room;
  room.fits = [](std::uint32_t) { return true; };
  room.slow_edge = tile_edge(kLarge);
  room.slow = [&] { return slow; };
  const auto objects = [&] {
    Objects out;
    const auto work = queue.take(room, false);
    if (!work) return out;
    for (const TileJob& job : std::get<std::vector<TileJob>>(*work)) out.push_back(job.key.object);
    return out;
  };
  submit(1, 1, key_of(1, kLarge));
  submit(1, 2, key_of(2, kLarge));
  submit(2, 1, key_of(3, kLarge));
  submit(3, 1, key_of(4));
  submit(4, 1, key_of(5));
  EXPECT_EQ(objects(), Objects{1}) << "alone";
  slow = false;  // it is under way
  EXPECT_EQ(objects(), (Objects{4, 5})) << "session 2, whose turn it is, waits";
  EXPECT_EQ(objects(), Objects{});
  ASSERT_TRUE(queue.submit(ReferenceJob{5, 1, {}}));
  queue.submit(ViewJob{});
  EXPECT_EQ(objects(), Objects{}) << "these are slow, too";
  slow = true;
  EXPECT_TRUE(std::holds_alternative<ReferenceJob>(*queue.take(room, false)));
  EXPECT_TRUE(std::holds_alternative<ViewJob>(*queue.take(room, false)));
  EXPECT_EQ(objects(), Objects{3}) << "session 1 has had its turn";
  EXPECT_EQ(objects(), Objects{2});
}

TEST_F(ServerQueue, AFullRenderIsWantedWhileWhoAskedIsThere) {
  ASSERT_TRUE(queue.submit(ReferenceJob{1, 1, {}}));
  ASSERT_TRUE(queue.take({[](std::uint32_t) { return true; }}, false));
  EXPECT_TRUE(queue.reference_wanted());
  queue.remove_session(2);
  EXPECT_TRUE(queue.reference_wanted());
  queue.remove_session(1);
  EXPECT_FALSE(queue.reference_wanted());
}

TEST_F(ServerQueue, AnIdleFullRenderComesAfterAllElse) {
  ReferenceJob idle{9, 0, {}};
  idle.idle = true;
  ASSERT_TRUE(queue.submit(idle));
  submit(1, 1, key_of(1));
  queue.submit(ViewJob{});
  TileQueue::Room room{[](std::uint32_t) { return true; }};
  EXPECT_TRUE(std::holds_alternative<ViewJob>(*queue.take(room, false)));
  EXPECT_EQ(take(), Objects{1});
  ASSERT_TRUE(queue.submit(ReferenceJob{5, 1, {}}));
  EXPECT_EQ(std::get<ReferenceJob>(*queue.take(room, false)).session, 5u) << "though it came later";
  room.idle = false;  // one is under way
  EXPECT_FALSE(queue.take(room, false));
  room.idle = true;
  queue.wait_for_levels();
  EXPECT_FALSE(queue.take(room, false)) << "levels come first";
  queue.levels_made();
  EXPECT_TRUE(std::holds_alternative<TileQueue::UploadLevels>(*queue.take(room, false)));
  EXPECT_EQ(std::get<ReferenceJob>(*queue.take(room, false)).session, 9u);
}

// Before levels are made, nobody may look at them.
TEST_F(ServerQueue, PicturesBeforeTheLevelsAreOfWholeMeshes) {
  TileQueue::Room room{[](std::uint32_t) { return true; }};
  ReferenceJob picture{5, 1, {}};
  picture.shot.level_px = 0.5;
  queue.wait_for_levels();
  ASSERT_TRUE(queue.submit(picture));
  EXPECT_TRUE(std::get<ReferenceJob>(*queue.take(room, false)).shot.whole);
  queue.levels_made();
  ASSERT_TRUE(queue.submit(picture));
  EXPECT_TRUE(std::holds_alternative<TileQueue::UploadLevels>(*queue.take(room, false)));
  EXPECT_FALSE(std::get<ReferenceJob>(*queue.take(room, false)).shot.whole);
}

TEST_F(ServerQueue, CloseEndsTheWait) {
  submit(1, 1, key_of(1));
  queue.close();
  EXPECT_FALSE(queue.take({[](std::uint32_t) { return true; }}, true));
}

TEST_F(ServerQueue, NothingIsLostInARandomHistory) {
  std::mt19937 engine(5);
  const auto random = [&] { return static_cast<std::uint32_t>(engine()); };
  enum class Fate { kOpen, kDelivered, kLate, kCancelled, kRemoved };
  std::map<std::pair<SessionId, std::uint32_t>, Fate> asks;
  std::vector<TileId> rendering;
  const auto settle = [&](const Waiter& w, Fate fate) {
    const auto at = asks.find({w.session, w.request_id});
    ASSERT_NE(at, asks.end());
    ASSERT_EQ(at->second, Fate::kOpen) << "session " << w.session << " ask " << w.request_id;
    at->second = fate;
  };
  const auto take_some = [&](std::size_t n) {
    const auto work = queue.take({[&](std::uint32_t) { return n-- > 0; }}, false);
    if (work) {
      for (const TileJob& job : std::get<std::vector<TileJob>>(*work)) rendering.push_back(job.id);
    }
    for (const Waiter& w : queue.take_late()) settle(w, Fate::kLate);
  };
  const auto finish_all = [&] {
    for (const TileId& id : rendering) {
      for (const Waiter& w : queue.finish(id)) settle(w, Fate::kDelivered);
    }
    rendering.clear();
  };
  std::uint32_t next_request = 1;
  std::int64_t now = 0;
  for (int i = 0; i < 30'000; ++i) {
    const SessionId session = 1 + random() % 5;
    clock.advance_to_us(now += 10);
    const unsigned what = random() % 100;
    if (what < 60) {
      const std::uint32_t request = next_request++;
      const std::int64_t deadline = random() % 3 == 0 ? now + random() % 2000 : 0;
      submit(session, request, key_of(random() % 300), static_cast<float>(random() % 50), deadline);
      asks[{session, request}] = Fate::kOpen;
    } else if (what < 75 && next_request > 1) {
      const std::uint32_t request = next_request - 1 - random() % std::min(next_request - 1, 50u);
      const auto at = asks.find({session, request});
      queue.cancel(session, request);
      if (at != asks.end() && at->second == Fate::kOpen) at->second = Fate::kCancelled;
    } else if (what < 90) {
      take_some(random() % 8);
    } else if (what < 99) {
      finish_all();
    } else if (random() % 10 == 0) {
      queue.remove_session(session);
      for (auto& [id, fate] : asks) {
        if (id.first == session && fate == Fate::kOpen) fate = Fate::kRemoved;
      }
    }
    if (HasFatalFailure()) return;
    if (i % 100 == 0) {
      const auto open = std::count_if(asks.begin(), asks.end(),
                                      [](const auto& ask) { return ask.second == Fate::kOpen; });
      ASSERT_LE(queue.ranks(), static_cast<std::size_t>(open));
    }
  }
  while (queue.length() > rendering.size()) take_some(100);
  finish_all();
  take_some(100);
  std::map<Fate, int> count;
  for (const auto& [id, fate] : asks) ++count[fate];
  EXPECT_EQ(count[Fate::kOpen], 0);
  EXPECT_GT(count[Fate::kDelivered], 1000);
  EXPECT_GT(count[Fate::kLate], 10);
  EXPECT_EQ(queue.length(), 0u);
}

}  // namespace
}  // namespace mirage::test
