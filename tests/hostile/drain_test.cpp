// Draining: a server that is told to stop serves what was asked for, and ends in time with any
// clients.

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <list>

#include "tests/hostile/beside.h"
#include "tests/hostile/client.h"

namespace mirage::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kDrainedScene = "builtin:knot?tubular=60&radial=12";

/// Returns the status line of GET /readyz; empty: nobody answers.
std::string ready_status(int port) {
  RawPeer peer(port);
  peer.say("GET /readyz HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  const std::string said = peer.hear_within(1000);
  return said.substr(0, said.find("\r\n"));
}

// Row 11: 31 of 60 used to be dropped.
TEST(Drain, WhatWasAskedForIsServed) {
  Server server(kDrainedScene, {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_EQ(ready_status(server.port()), "HTTP/1.1 200 OK");
  Client client(server.port());
  std::vector<wire::Ask> asks;
  constexpr std::uint32_t kAsks = 60;
  for (std::uint32_t i = 1; i <= kAsks; ++i) asks.push_back(new_tile(i, kMiddle + 2));
  client.ask(std::move(asks));
  client.send(wire::StatsRequestT{});
  int tiles = 0, byes = 0;
  while (const std::optional<Message> message = client.next(2000)) {
    tiles += message->body.AsTileReply() ? 1 : 0;
    if (message->body.AsStats()) break;  // it has read the asks
  }
  const int before = tiles;
  kill(server.pid(), SIGTERM);
  const Clock::time_point start = Clock::now();
  std::string status;
  bool upgraded = true;
  while (const std::optional<Message> message = client.next(5000)) {
    tiles += message->body.AsTileReply() ? 1 : 0;
    byes += message->body.AsBye() ? 1 : 0;
    if (!status.empty()) continue;
    status = ready_status(server.port());
    upgraded = WebSocket(server.port()).open();
    client.ask({new_tile(1000, kSmall)});
  }
  std::printf("11: %d of %u tiles, %d of them before SIGTERM, close %d, %.2f s\n", tiles, kAsks,
              before, client.close_code(), seconds_since(start));
  EXPECT_EQ(tiles, static_cast<int>(kAsks)) << "and nothing new";
  EXPECT_EQ(byes, 1);
  EXPECT_EQ(client.close_code(), 1001);
  EXPECT_NE(status.find("503"), std::string::npos) << "the next client goes elsewhere";
  EXPECT_FALSE(upgraded);
  EXPECT_EQ(server.wait(5), 0) << server.log();
}

struct End {
  int exit_code;
  double seconds;
};
End end_of(Server& server) {
  const Clock::time_point start = Clock::now();
  kill(server.pid(), SIGTERM);
  const int code = server.wait(30);
  return {code, seconds_since(start)};
}

TEST(Drain, NoLongerThanItIsTold) {
  Server server(kDrainedScene, {"--no-view", "--drain-s", "1"});
  ASSERT_TRUE(server.ready()) << server.log();
  Client client(server.port());
  std::vector<wire::Ask> asks;
  for (std::uint32_t i = 1; i <= 200; ++i) asks.push_back(new_tile(i, kLargest));
  client.ask(std::move(asks));
  client.next(5000);
  const End end = end_of(server);
  std::printf("11: --drain-s 1 with 200 of the largest tiles: %.2f s\n", end.seconds);
  EXPECT_EQ(end.exit_code, 0) << server.log();
  EXPECT_GT(end.seconds, 0.9);
  // The server has another second for goodbyes, and for a page of tiles that it has begun.
  EXPECT_LT(end.seconds, 5);
}

TEST(Drain, WhoDoesNotReadHoldsUpNothingLonger) {
  Server server("builtin:knot?tubular=400&radial=64", {"--no-view", "--drain-s", "1"});
  ASSERT_TRUE(server.ready()) << server.log();
  Client client(server.port(), "", PeerFrom{"127.0.0.1", 4096});
  wire::RequestBatchT batch;
  for (std::uint32_t i = 1; i <= 1000; ++i) batch.mesh_asks.emplace_back(i, 0u, 0);
  client.send(std::move(batch));
  std::list<WebSocket> silent;
  for (int i = 0; i < 10; ++i) silent.emplace_back(server.port());
  RawPeer half(server.port());
  half.say("GET / HT");
  const End end = end_of(server);
  std::printf("11: --drain-s 1 with one who does not read, 10 silent: %.2f s\n", end.seconds);
  EXPECT_EQ(end.exit_code, 0) << server.log();
  EXPECT_LT(end.seconds, 4);
}

TEST(Drain, AnIdleServerEndsAtOnce) {
  Server server(kDrainedScene, {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  Client client(server.port());
  ASSERT_TRUE(client.greeted());
  kill(server.pid(), SIGTERM);
  const Clock::time_point start = Clock::now();
  while (client.next(3000)) continue;
  EXPECT_EQ(client.close_code(), 1001);
  EXPECT_EQ(server.wait(20), 0) << server.log();
  const double seconds = seconds_since(start);
  std::printf("11: an idle server with one client: %.2f s\n", seconds);
  EXPECT_LT(seconds, 3) << "a second for goodbyes";
}

}  // namespace
}  // namespace mirage::test
