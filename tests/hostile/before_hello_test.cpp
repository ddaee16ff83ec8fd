// Peers that have not said hello: what they may send, how many there may be, and that they take
// nobody's place.

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <list>
#include <thread>

#include "tests/hostile/beside.h"
#include "tests/hostile/client.h"

namespace mirage::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kScene = "builtin:knot?tubular=60&radial=12";

/// Returns a piece of a transfer of 1 MiB, which a client may have under way.
std::string chunk(std::uint32_t transfer, std::uint32_t offset, std::size_t bytes) {
  Bytes out(kWireHeaderBytes + kChunkPrefixBytes + bytes);
  PacketHeader header;
  header.kind = PacketKind::kChunk;
  header.payload_bytes = static_cast<std::uint32_t>(kChunkPrefixBytes + bytes);
  write_packet_header(header, out.data());
  std::uint8_t* at = out.data() + kWireHeaderBytes;
  const std::uint32_t total = limits::kMaxInboundTransferBytes;
  for (const std::uint32_t word : {transfer, total, offset}) {
    for (int i = 0; i < 4; ++i) *at++ = static_cast<std::uint8_t>(word >> (8 * i));
  }
  return text_of(out);
}

// Row 6: 3.5 MB of chunks a peer used to be kept for as long as the peer stayed.
TEST(BeforeTheHello, ChunksAreKeptForNobody) {
  const Server server(kScene, {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  std::list<WebSocket> peers;
  const Cost cost = cost_of("6, chunks of 32 strangers", server, [&] {
    for (int i = 0; i < 32; ++i) {
      // Each peer has its own address, so none is sent away for another's failure.
      WebSocket& peer =
          peers.emplace_back(server.port(), PeerFrom{"127.0.6." + std::to_string(1 + i)});
      ASSERT_TRUE(peer.open());
      for (std::uint32_t piece = 0; piece < 7; ++piece) {
        for (std::uint32_t transfer = 1; transfer <= 4; ++transfer) {
          const auto offset = static_cast<std::uint32_t>(piece * limits::kChunkBytes);
          peer.say(ClientFrame{2, chunk(transfer, offset, limits::kChunkBytes)});
        }
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  });
  // A message is at most 256 KiB while it arrives, and each peer has one: 8 MB.
  EXPECT_LT(cost.more_mb(), 16);
  expect_served(cost, 300);
  for (WebSocket& peer : peers) {
    const std::optional<ServerFrame> said = peer.next(2000);
    EXPECT_TRUE(said ? said->close_code() == 1009 : peer.ended());
  }
}

TEST(BeforeTheHello, SilentSocketsTakeNoPlaces) {
  const Server server(kScene, {"--no-view", "--max-clients", "3"});
  ASSERT_TRUE(server.ready()) << server.log();
  const Cost cost = cost_of("6, 60 silent, 3 places", server, [&] {
    std::list<WebSocket> silent;
    for (int i = 0; i < 60; ++i) silent.emplace_back(server.port());
    Client second(server.port()), third(server.port()), fourth(server.port());
    EXPECT_TRUE(second.greeted() && third.greeted());
    EXPECT_GE(second.tile_ms(kSmall), 0);
    EXPECT_FALSE(fourth.greeted()) << "three are there";
    EXPECT_EQ(fourth.close_code(), 4013);
  });
  expect_served(cost, 300);
}

TEST(BeforeTheHello, OfManyStrangersTheFirstAreClosed) {
  const Server server(kScene, {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  Client first(server.port());
  std::list<WebSocket> strangers;
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(strangers.emplace_back(server.port()).open());
  int closed = 0, told = 0;
  for (const Clock::time_point start = Clock::now(); closed < 44 && seconds_since(start) < 3;) {
    for (WebSocket& peer : strangers) {
      if (peer.ended()) continue;
      const std::optional<ServerFrame> said = peer.next(0);
      told += said ? 1 : 0;
      closed += peer.ended() ? 1 : 0;
    }
  }
  std::printf("6, 300 silent: %d closed, %d told why\n", closed, told);
  EXPECT_EQ(closed, 44) << "of 300 there are 256 left";
  EXPECT_GE(first.tile_ms(kSmall), 0) << "who is greeted stays";
  EXPECT_TRUE(Client(server.port()).greeted());
}

TEST(BeforeTheHello, WrongTokensAreTriedTenTimesASecond) {
  const std::string token = scratch_folder() + "/token";
  std::ofstream(token) << "right\n";
  const Server server(kScene, {"--no-view", "--token-file", token});
  ASSERT_TRUE(server.ready()) << server.log();
  constexpr double kSeconds = 1.5;
  int heard = 0, refused = 0;
  const auto guess = [&] {
    const Clock::time_point start = Clock::now();
    while (seconds_since(start) < kSeconds) {
      WebSocket peer(server.port(), PeerFrom{"127.0.6.66"});
      ++(peer.open() ? heard : refused);
      if (!peer.open()) continue;
      peer.say(ClientFrame{2, text_of(encode_message(hello("wrong")))});
      const std::optional<ServerFrame> said = peer.next(2000);
      EXPECT_TRUE(said && said->close_code() == 4003);
    }
  };
  const Cost cost = cost_of("6, wrong tokens", server, guess, "right");
  std::printf("   %.0f wrong tokens a second were looked at, %.0f connections refused\n",
              heard / kSeconds, refused / kSeconds);
  EXPECT_LE(heard, 10 * (kSeconds + 1)) << "ten within any second";
  EXPECT_GE(heard, 10) << "a mistake is not the end";
  expect_served(cost, 300);
  EXPECT_NE(server.log().find("127.0.6.66"), std::string::npos) << "the log says who";
}

TEST(BeforeTheHello, WhatIsNoHelloOfFourKilobytesIsClosed) {
  const Server server(kScene, {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  int peers = 0;
  const auto answer = [&](const std::string& message) {
    WebSocket peer(server.port(), PeerFrom{"127.0.7." + std::to_string(++peers)});
    peer.say(ClientFrame{2, message});
    const std::optional<ServerFrame> said = peer.next(2000);
    if (!said) return 0;
    return said->opcode == 8 ? said->close_code() : 1;  // 1: a welcome
  };
  const std::size_t bare = encode_message(hello()).size();
  const auto hello_of = [&](std::size_t bytes) {
    return text_of(encode_message(hello(), Bytes(bytes - bare)));
  };
  EXPECT_EQ(answer(hello_of(bare)), 1);
  EXPECT_EQ(answer(hello_of(4096)), 1);
  EXPECT_EQ(answer(hello_of(4097)), 1009);
  EXPECT_EQ(answer(hello_of(250'000)), 1009);
  EXPECT_EQ(answer(text_of(encode_message(wire::StatsRequestT{}))), 1002);
  EXPECT_EQ(answer(text_of(encode_message(wire::RequestBatchT{}))), 1002);
  EXPECT_EQ(answer(chunk(1, 0, 100)), 1002);
  EXPECT_EQ(answer(std::string(100, 'x')), 1002);
}

}  // namespace
}  // namespace mirage::test
