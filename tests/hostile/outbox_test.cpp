// Outbox: what waits for a client that asks and does not read is limited, and nobody else waits.

#include <gtest/gtest.h>

#include <chrono>
#include <list>
#include <thread>

#include "tests/hostile/beside.h"
#include "tests/hostile/client.h"

namespace mirage::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kKnot = "builtin:knot?tubular=60&radial=12";
/// A knot whose mesh is 200 KB.
constexpr const char* kLargeKnot = "builtin:knot?tubular=400&radial=64";
constexpr double kOutboxMb = 16;
const PeerFrom kReadsLittle{"127.0.0.1", 4096};
/// Memory that an allocator and a WebSocket's own buffers keep, whatever a client does.
constexpr double kSpareMb = 24;

void pause(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

wire::RequestBatchT meshes(std::uint32_t first, std::uint32_t count) {
  wire::RequestBatchT batch;
  for (std::uint32_t i = 0; i < count; ++i) batch.mesh_asks.emplace_back(first + i, 0u, 0);
  return batch;
}

// Row 4: 12 KB of asks used to make 193 MB of answers.
TEST(Outbox, AThousandAsksForAMeshAreMadeAsTheyAreRead) {
  const Server server(kLargeKnot, {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  std::list<Client> peers;
  const Cost cost = cost_of("4, 4 x 1000 asks for a mesh, unread", server, [&] {
    for (int i = 0; i < 4; ++i) {
      peers.emplace_back(server.port(), "", kReadsLittle).send(meshes(1, 1000));
    }
    pause(1500);
  });
  EXPECT_LT(cost.more_mb(), kSpareMb) << "one mesh a client";
  expect_served(cost, 300);
  // A client that reads in the end gets them, one after another.
  int got = 0;
  while (got < 20 && peers.front().next(2000)) ++got;
  EXPECT_EQ(got, 20);
}

// Repeated asks for one tile are answered from memory: each answer is a copy.
TEST(Outbox, TilesThatAreNotReadAreRefusedBeyondTheBudget) {
  const Server server(kKnot, {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  std::list<Client> peers;
  std::uint32_t request = 1;
  const Cost cost = cost_of("4, 3 x 4000 tiles of 256 texels, unread", server, [&] {
    const wire::Ask one = new_tile(1, kMiddle);
    const auto again = [&] {
      return wire::Ask(++request, 0, 0, 1, 0, one.distance_index(), one.view_x(), one.view_y(),
                       one.view_level(), one.distance_level(), kMiddle, one.channels(), 0);
    };
    for (int i = 0; i < 3; ++i) {
      Client& peer = peers.emplace_back(server.port(), "", kReadsLittle);
      peer.ask({again()});
      pause(200);  // it is in memory then
      for (int batch = 0; batch < 4; ++batch) {
        std::vector<wire::Ask> asks;
        for (int k = 0; k < 1000; ++k) asks.push_back(again());
        peer.ask(std::move(asks));
      }
    }
    pause(1500);
  });
  EXPECT_LT(cost.more_mb(), 3 * kOutboxMb + kSpareMb);
  expect_served(cost, 300);
  int tiles = 0, refused = 0;
  while (const std::optional<Message> message = peers.front().next(1000)) {
    tiles += message->body.AsTileReply() ? 1 : 0;
    const wire::RefusedT* no = message->body.AsRefused();
    refused += no && no->reason == wire::RefusalReason::Busy ? 1 : 0;
  }
  EXPECT_EQ(tiles + refused, 4001) << "each is answered";
  EXPECT_GT(tiles, 100);
  EXPECT_GT(refused, 100);
}

// Credit does not limit small answers, so beyond the budget only closing helps.
TEST(Outbox, WhoDoesNotEvenReadRefusalsIsClosed) {
  const Server server(kKnot, {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  const Cost cost = cost_of("4, small answers, unread", server, [&] {
    Client peer(server.port(), "", kReadsLittle);
    std::vector<wire::Ask> wrong(1000, wire::Ask(1, 9, 9, 1, 0, 8, 0, 0, 9, 2, 2, 3, 0));
    wire::RequestBatchT batch;
    batch.asks = std::move(wrong);
    const std::string bytes = ClientFrame{2, text_of(encode_message(batch))}.bytes();
    const Clock::time_point until = Clock::now() + std::chrono::seconds(5);
    int said = 0;
    for (; Clock::now() < until && server.log().find("does not read") == std::string::npos;
         ++said) {
      peer.socket().say(bytes);
    }
    std::printf("   closed after %d refusals\n", said * 1000);
    EXPECT_NE(server.log().find("does not read"), std::string::npos);
  });
  // A refusal of 80 bytes takes 250 with its container; and other messages were sent meanwhile.
  EXPECT_LT(cost.more_mb(), 4 * kOutboxMb + kSpareMb);
  expect_served(cost, 300);
}

// Row 5: it used to be 1.2 GB in 4 s. Asks that are cancelled come after large tiles, so none of
// them is ever drawn.
TEST(Outbox, AskingAndCancellingLeavesNothing) {
  const Server server(kKnot, {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  int asked = 0;
  const Cost cost = cost_of("5, ask + cancel for 2 s", server, [&] {
    Client peer(server.port());
    constexpr float kWorthMost = 1000, kWorthLittle = 0.001f;
    std::vector<wire::Ask> large;
    for (std::uint32_t i = 1; i <= 100; ++i) {
      large.push_back(new_tile(10'000 + i, kMiddle + 2, 0, kWorthMost));
    }
    peer.ask(std::move(large));
    const Clock::time_point until = Clock::now() + std::chrono::seconds(2);
    while (Clock::now() < until) {
      wire::RequestBatchT ask, cancel;
      for (std::uint32_t i = 1; i <= 1000; ++i) {
        ask.asks.push_back(new_tile(i, kSmall, 0, kWorthLittle));
        cancel.cancels.push_back(i);
      }
      asked += 1000;
      peer.send(std::move(ask));
      peer.send(std::move(cancel));
      while (peer.next(0)) continue;
    }
  });
  std::printf("   %d asks\n", asked);
  EXPECT_GT(asked, 20'000) << "few asks prove little";
  // The asks of a batch are kept; the large tiles are drawn in pages and kept.
  EXPECT_LT(cost.more_mb(), 36);
  expect_served(cost, 1500);
}

// A kilobyte now and then is progress: the client stays, with what may wait for it.
TEST(Outbox, WhoDripsKeepsNoMoreThanTheBudget) {
  const Server server(kLargeKnot, {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  const Cost cost = cost_of("4, 8 who read 1 KB every 50 ms", server, [&] {
    std::list<Client> peers;
    for (int i = 0; i < 8; ++i) {
      peers.emplace_back(server.port(), "", kReadsLittle).send(meshes(1, 1000));
    }
    for (int i = 0; i < 30; ++i) {
      for (Client& peer : peers) peer.socket().peer().hear_within(0, 1024);
      pause(50);
    }
    for (Client& peer : peers) EXPECT_FALSE(peer.socket().ended());
  });
  EXPECT_LT(cost.more_mb(), kSpareMb);
  expect_served(cost, 300);
}

}  // namespace
}  // namespace mirage::test
