// Tiles kept in a directory: looked for off the network loop, merged, and given up if it is slow.
#include <gtest/gtest.h>

#include <thread>

#include "server/source/directory_source.h"
#include "server/stage/fetch_stage.h"
#include "server/tile/tile_form.h"
#include "tests/support/session_hub_test.h"
#include "tests/support/temp_folder.h"

namespace mirage::test {
namespace {

constexpr std::int64_t kSoonUs = 1'000, kTooLateUs = 150'000, kLongAfterUs = 20'000'000;

/// A server that keeps tiles in a directory; restart_server() forgets what is in memory.
class ServerFetch : public SessionHubTest {
 protected:
  ServerFetch() { restart_server(); }

  void restart_server() {
    hub.reset();
    server = std::make_unique<StageQueues>(clock, 1 << 24, TileSources{&source});
    hub = std::make_unique<SessionHub>(scene_, SessionOptions{}, *server);
  }
  /// Does the fetch stage's work on everything that waits. Returns the number of jobs.
  int fetch_all() {
    int jobs = 0;
    while (const std::optional<FetchJob> job = server->fetches.try_pop()) {
      finish(*job);
      ++jobs;
    }
    return jobs;
  }
  void finish(const FetchJob& job) {
    hub->complete(FinishedFetch{job.id, job.codec, server->store.fetch(job.id, job.codec)});
  }
  /// Does the work of render and encode stage on everything that waits, and keeps it in the
  /// directory.
  std::size_t render_all_and_keep() {
    auto work = server->tiles.take({[](std::uint32_t) { return true; }}, false);
    if (!work) return 0;
    const auto jobs = std::get<std::vector<TileJob>>(std::move(*work));
    for (const TileJob& job : jobs) {
      const StoredTilePtr tile = tile_of(job.id);
      server->store.put(job.id, TileCodec::kZstd, tile);
      server->store.save(job.id, TileCodec::kZstd, *tile);
      hub->complete(FinishedTile{job.id, TileCodec::kZstd, tile, tile});
    }
    return jobs.size();
  }
  static StoredTilePtr tile_of(const TileId& id) {
    Tile tile;
    tile.edge = 64;
    tile.crop = {0, 0, 4, 4};
    tile.measure = {4, 3.5f, 4.5f, 0.5f, 0.25f, 0.125f, 0.1f};
    tile.rgba.assign(64, static_cast<std::uint8_t>(id.low));
    tile.depth.assign(16, 100);
    wire::TileReplyT fields;
    fields.key_low = id.low;
    fields.key_high = id.high;
    return make_form(tile, fields, TileCodec::kZstd);
  }
  SessionId client() {
    const SessionId id = hub->open();
    EXPECT_TRUE(send(id, hello({TileCodec::kZstd})).ok());
    drain(id);
    return id;
  }
  /// Returns the requests whose tiles arrived.
  std::vector<std::uint32_t> came(SessionId id) {
    std::vector<std::uint32_t> out;
    for (const Message& m : drain(id)) {
      if (const auto* tile = m.body.AsTileReply()) out.push_back(tile->request_id);
    }
    return out;
  }
  void wait_for(std::int64_t us) {
    clock.advance_to_us(clock.now_us() + us);
    hub->give_up_fetches();
  }
  /// Puts the tile of this view cell into the directory, and restarts the server.
  void keep(std::uint16_t cell) {
    ASSERT_TRUE(send_ask(client(), ask(1, cell)).ok());
    fetch_all();
    ASSERT_EQ(render_all_and_keep(), 1u);
    restart_server();
  }

  const TempFolder folder;
  CacheDirectory directory{folder.path().string(), 1u << 30};
  DirectorySource source{directory};
  std::unique_ptr<StageQueues> server;
};
using Requests = std::vector<std::uint32_t>;

TEST_F(ServerFetch, WhatIsKeptComesWithoutBeingRenderedAndNotOnTheLoop) {
  keep(0);
  const SessionId id = client();
  ASSERT_TRUE(send_ask(id, ask(7)).ok());
  EXPECT_EQ(came(id), Requests{}) << "the loop does not look itself";
  EXPECT_EQ(server->tiles.length(), 0u) << "nor is it rendered meanwhile";
  EXPECT_EQ(fetch_all(), 1);
  EXPECT_EQ(came(id), Requests{7});
  EXPECT_EQ(server->counters.store_hits, 1u);
  EXPECT_EQ(server->counters.tiles_rendered, 0u);
  ASSERT_TRUE(send_ask(id, ask(8)).ok());
  EXPECT_EQ(came(id), Requests{8}) << "in memory now";
}

TEST_F(ServerFetch, WhatIsNotKeptIsRendered) {
  const SessionId id = client();
  ASSERT_TRUE(send_ask(id, ask(7)).ok());
  EXPECT_EQ(server->tiles.length(), 0u);
  EXPECT_EQ(fetch_all(), 1);
  EXPECT_EQ(server->tiles.length(), 1u);
  EXPECT_EQ(render_all_and_keep(), 1u);
  EXPECT_EQ(came(id), Requests{7});
}

TEST_F(ServerFetch, EqualAsksAreLookedForOnceAndRenderedOnce) {
  const SessionId a = client(), b = client();
  ASSERT_TRUE(send_ask(a, ask(1)).ok());
  ASSERT_TRUE(send_ask(b, ask(2)).ok());
  ASSERT_TRUE(send_ask(b, ask(3)).ok());
  EXPECT_EQ(fetch_all(), 1);
  EXPECT_EQ(server->tiles.length(), 1u);
  EXPECT_EQ(render_all_and_keep(), 1u);
  EXPECT_EQ(came(a), Requests{1});
  EXPECT_EQ(came(b), (Requests{2, 3}));
}

TEST_F(ServerFetch, ASlowDirectoryIsGivenUpAndLeftAloneForAWhile) {
  keep(0);
  const SessionId id = client();
  ASSERT_TRUE(send_ask(id, ask(1)).ok());
  const FetchJob slow = *server->fetches.try_pop();
  wait_for(kSoonUs);
  EXPECT_EQ(server->tiles.length(), 0u);
  wait_for(kTooLateUs);
  EXPECT_EQ(server->tiles.length(), 1u);
  EXPECT_EQ(server->counters.fetches_given_up, 1u);
  ASSERT_TRUE(send_ask(id, ask(2, 5)).ok());
  EXPECT_EQ(fetch_all(), 0) << "it is not asked again";
  EXPECT_EQ(server->tiles.length(), 2u);
  finish(slow);  // late: it serves those who ask from now on
  EXPECT_EQ(came(id), Requests{});
  ASSERT_TRUE(send_ask(id, ask(3)).ok());
  EXPECT_EQ(came(id), Requests{3});
  EXPECT_EQ(render_all_and_keep(), 2u);
  EXPECT_EQ(came(id), (Requests{1, 2}));
}

TEST_F(ServerFetch, AfterwardsItIsTriedWithOneTileAtATime) {
  const SessionId id = client();
  ASSERT_TRUE(send_ask(id, ask(1)).ok());
  wait_for(kTooLateUs);
  clock.advance_to_us(clock.now_us() + kLongAfterUs);
  ASSERT_TRUE(send_ask(id, ask(2, 2)).ok());
  ASSERT_TRUE(send_ask(id, ask(3, 3)).ok());
  EXPECT_EQ(fetch_all(), 1);
  ASSERT_TRUE(send_ask(id, ask(4, 4)).ok());
  ASSERT_TRUE(send_ask(id, ask(5, 5)).ok());
  EXPECT_EQ(fetch_all(), 2) << "it came in time: all is as before";
}

// A disk that paused once is asked again soon; one that hangs is asked less and less often.
TEST_F(ServerFetch, TheMoreOftenItIsSlowTheLongerItIsLeftAlone) {
  constexpr int kStepMs = 125;
  const SessionId id = client();
  std::uint16_t asks = 0;
  std::optional<FetchJob> job;  // taken by a reader that hangs
  const auto is_asked = [&] {
    ++asks;
    EXPECT_TRUE(send_ask(id, ask(asks, asks)).ok());
    job = server->fetches.try_pop();
    return job.has_value();
  };
  const auto left_alone_ms = [&] {
    wait_for(kTooLateUs);
    int ms = 0;
    for (; !is_asked(); ms += kStepMs) clock.advance_to_us(clock.now_us() + 1000 * kStepMs);
    return ms;
  };
  ASSERT_TRUE(is_asked());
  for (const int ms : {250, 500, 1000, 2000, 4000, 8000, 10'000, 10'000}) {
    EXPECT_EQ(left_alone_ms(), ms);
  }
  finish(*job);
  ASSERT_TRUE(is_asked());
  EXPECT_EQ(left_alone_ms(), 250) << "one came in time in between";
}

TEST_F(ServerFetch, WhoIsGoneOrCancelsGetsNothingAndHasNothingRendered) {
  const SessionId a = client(), b = client(), c = client();
  ASSERT_TRUE(send_ask(a, ask(1, 1)).ok());
  ASSERT_TRUE(send_ask(b, ask(1, 2)).ok());
  ASSERT_TRUE(send_ask(c, ask(1, 2)).ok());
  wire::RequestBatchT cancel;
  cancel.cancels = {1};
  ASSERT_TRUE(send(b, std::move(cancel)).ok());
  hub->close(a);
  EXPECT_EQ(fetch_all(), 2);
  EXPECT_EQ(server->tiles.length(), 1u) << "c still wants its tile";
  EXPECT_EQ(server->counters.tiles_cancelled, 1u);
  render_all_and_keep();
  EXPECT_EQ(came(b), Requests{});
  EXPECT_EQ(came(c), Requests{1});
}

/// A source in which another server makes every tile, until the test says that it has it.
class BusyElsewhere final : public TileSource {
 public:
  Tier tier() const override { return Tier::kRedis; }
  std::int64_t patience_us() const override { return 30'000; }
  std::optional<Bytes> fetch(const FormId&) override {
    if (!there) return std::nullopt;
    return record;
  }
  bool offer(const FormId&, const Bytes& offered) override {
    record = offered;
    return true;
  }
  bool claim(const TileId&) override { return gone; }
  std::atomic<bool> there{false}, gone{false};
  Bytes record;
};

TEST_F(ServerFetch, WhatAnotherServerRendersIsLookedForAgain) {
  BusyElsewhere elsewhere;
  const auto with_stage = [&](const std::function<void(SessionId)>& act) {
    hub.reset();
    server = std::make_unique<StageQueues>(clock, 1 << 24, TileSources{&elsewhere});
    hub = std::make_unique<SessionHub>(scene_, SessionOptions{}, *server);
    FetchStage stage(*server, [] {});
    stage.start();
    act(client());
    server->fetches.close();
    server->saves.close();
    stage.join();
  };
  const auto complete_one = [&] {
    std::optional<Completion> done = server->completions.pop();
    const bool pending = std::holds_alternative<PendingFetch>(*done);
    hub->complete(std::move(*done));
    return pending;
  };
  with_stage([&](SessionId id) {
    ASSERT_TRUE(send_ask(id, ask(7)).ok());
    ASSERT_TRUE(complete_one());
    EXPECT_EQ(server->counters.tiles_left_to_others, 1u);
    wait_for(kTooLateUs);
    EXPECT_EQ(server->tiles.length(), 0u) << "the other has longer than a disk";
    elsewhere.gone = true;  // its lease has ended, so this server makes the tile
    ASSERT_FALSE(complete_one());
    EXPECT_EQ(render_all_and_keep(), 1u);
    EXPECT_EQ(came(id), Requests{7});
  });
  elsewhere.gone = false;
  with_stage([&](SessionId id) {
    ASSERT_TRUE(send_ask(id, ask(8)).ok());
    ASSERT_TRUE(complete_one());
    elsewhere.there = true;
    ASSERT_FALSE(complete_one());
    EXPECT_EQ(came(id), Requests{8});
    EXPECT_EQ(server->counters.shared_store_hits, 1u);
    EXPECT_EQ(server->tiles.length(), 0u);
  });
}

TEST_F(ServerFetch, TheStageReadsAndWritesOnThreadsOfItsOwn) {
  keep(0);
  FetchStage stage(*server, [] {});
  stage.start();
  const SessionId id = client();
  ASSERT_TRUE(send_ask(id, ask(7)).ok());
  std::optional<Completion> done = server->completions.pop();
  ASSERT_TRUE(done && std::holds_alternative<FinishedFetch>(*done));
  hub->complete(std::move(*done));
  EXPECT_EQ(came(id), Requests{7});
  const TileId other{1, 2};
  server->saves.push({other, TileCodec::kZstd, tile_of(other)});
  server->fetches.close();
  server->saves.close();
  stage.join();  // pending writes are done
  EXPECT_TRUE(server->store.fetch(other, TileCodec::kZstd).form);
}

}  // namespace
}  // namespace mirage::test
