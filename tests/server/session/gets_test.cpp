// Tiles requested one by one over HTTP, at sessions without sockets.
#include <gtest/gtest.h>

#include "protocol/wire/tile_address.h"
#include "tests/support/session_hub_test.h"

namespace mirage::test {
namespace {

class ServerGets : public SessionHubTest {
 protected:
  static TileAddress address(std::uint16_t x = 0) {
    TileAddress out;  // address of the tile of ask()
    out.cell = {9, x, 0};
    out.distance = {2, 8};
    out.size_class = 2;
    out.channels = kLitTile;
    return out;
  }
};

TEST_F(ServerGets, ATileIsRenderedOnceForAllWhoWantIt) {
  const std::uint32_t a = hub->get(address()), b = hub->get(address());
  ASSERT_TRUE(send_ask(greeted(), ask(1)).ok());
  EXPECT_TRUE(hub->take_got().empty());
  EXPECT_EQ(queue.length(), 1u);
  EXPECT_EQ(render_all(), 1u);
  const std::vector<GotTile> got = hub->take_got();
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].request, a);
  EXPECT_EQ(got[1].request, b);
  EXPECT_FALSE(got[0].message.empty());
  EXPECT_EQ(got[0].message, got[1].message);
  EXPECT_TRUE(hub->take_got().empty());
  hub->get(address());
  EXPECT_EQ(hub->take_got().size(), 1u) << "from memory";
}

TEST_F(ServerGets, TheBytesDoNotTellWhoRenderedItAndWhen) {
  hub->get(address());
  render_all();
  const std::vector<GotTile> got = hub->take_got();
  ASSERT_EQ(got.size(), 1u);
  const Message message = decode_message(got[0].message.data(), got[0].message.size()).take();
  const wire::TileReplyT& reply = *message.body.AsTileReply();
  EXPECT_EQ(reply.content_hash, sample_tile_reply().content_hash);
  EXPECT_EQ(got[0].content_hash, reply.content_hash);
  EXPECT_EQ(reply.request_id + reply.server_us + reply.queue_us + reply.render_us + reply.encode_us,
            0u);
}

TEST_F(ServerGets, WhatThereIsNotIsRefused) {
  const auto refusal_of = [&](const TileAddress& wanted) {
    hub->get(wanted);
    const std::vector<GotTile> got = hub->take_got();
    return got.size() == 1 ? got[0].reason : wire::RefusalReason::None;
  };
  TileAddress wrong = address();
  wrong.instance = 1000;
  EXPECT_EQ(refusal_of(wrong), wire::RefusalReason::UnknownObject);
  wrong = address();
  wrong.cell.level = 200;
  EXPECT_EQ(refusal_of(wrong), wire::RefusalReason::BadKey);
  wrong = address();
  wrong.phase = 7;
  EXPECT_EQ(refusal_of(wrong), wire::RefusalReason::BadKey);
  SessionOptions zstd_only;
  zstd_only.codecs = {TileCodec::kZstd};
  restart(zstd_only);
  wrong = address();
  wrong.codec = TileCodec::kWebp;
  EXPECT_EQ(refusal_of(wrong), wire::RefusalReason::BadKey);
  hub->drain();
  EXPECT_EQ(refusal_of(address()), wire::RefusalReason::Busy);
}

TEST_F(ServerGets, WhoWaitsTooLongOrIsGoneHasNothingRendered) {
  hub->get(address(1));
  const std::uint32_t gone = hub->get(address(2));
  hub->cancel_get(gone);
  EXPECT_EQ(queue.length(), 1u);
  clock.advance_to_us(clock.now_us() + 6'000'000);
  EXPECT_EQ(take_tiles().size(), 0u);
  hub->refuse_late();
  const std::vector<GotTile> got = hub->take_got();
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].reason, wire::RefusalReason::Late);
}

TEST_F(ServerGets, TogetherTheyTakeTurnsWithEachClient) {
  for (std::uint16_t x = 0; x < 40; ++x) hub->get(address(x));
  const SessionId id = greeted();
  ASSERT_TRUE(send_ask(id, ask(1, 100)).ok());
  int before = 0;
  for (bool first = true; before < 40; ++before, first = true) {
    auto work = queue.take({[&](std::uint32_t) { return std::exchange(first, false); }}, false);
    ASSERT_TRUE(work);
    if (std::get<std::vector<TileJob>>(*work)[0].key.cell.x == 100) break;
  }
  EXPECT_LE(before, 2);
}

}  // namespace
}  // namespace mirage::test
