// Codecs of tiles, from the hello to the reply: what both ends have, what a batch asks for, and
// forms made from stored ones.
#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <thread>

#include "protocol/codec/tile_codec.h"
#include "protocol/wire/conversions.h"
#include "server/stage/encode_stage.h"
#include "server/tile/tile_encode.h"
#include "tests/support/session_hub_test.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kEdge = 23;  // of size class 1

// The shipped encode stage behind the hub; only the drawing is made up.
class ServerCodec : public SessionHubTest {
 protected:
  ServerCodec() { restart_with({}); }
  ~ServerCodec() override {
    queues.close_drawn();
    encode.join();
  }
  void restart_with(std::vector<TileCodec> codecs) {
    SessionOptions options;
    options.shadows = true;
    if (!codecs.empty()) options.codecs = std::move(codecs);
    restart(std::move(options));
  }
  /// Greets with these codecs. Returns the welcome.
  std::pair<SessionId, wire::WelcomeT> greet(const std::vector<TileCodec>& codecs) {
    const SessionId id = hub->open();
    EXPECT_TRUE(send(id, hello(codecs)).ok());
    return {id, *drain(id).at(0).body.AsWelcome()};
  }
  void ask_in(SessionId id, std::optional<TileCodec> codec, std::uint16_t cell = 0,
              std::uint8_t channels = kLitTile) {
    wire::RequestBatchT batch;
    batch.asks = {ask(++request, cell, 1, channels)};
    batch.credit_bytes = 1 << 30;
    if (codec) batch.codec = static_cast<std::uint8_t>(*codec);
    EXPECT_TRUE(send(id, std::move(batch)).ok());
  }
  /// Draws what is queued. Returns the number of tiles.
  std::size_t draw() {
    const std::vector<TileJob> tiles = take_tiles();
    for (const TileJob& job : tiles) {
      ++counters.tiles_rendered;
      auto page = std::make_shared<PagePixels>();
      page->width = page->height = static_cast<int>(kEdge);
      for (std::uint32_t i = 0; i < kEdge * kEdge; ++i) {
        // Colours without grain: zstd would be as small as any.
        const std::uint32_t grain = (i * 2654435761u >> 24) % 16;
        for (const std::uint32_t c : {60 + grain, 90 + i / 8 + grain / 2, 200 - grain, 255u}) {
          page->rgba.push_back(static_cast<std::uint8_t>(c));
        }
        page->depth.push_back(static_cast<std::uint8_t>(100 + i % 9));
      }
      encode_jobs.push(RenderedTile{job, page, 0, 0, 0, 0});
    }
    return tiles.size();
  }
  /// Waits for the next completion of the encode stage, and hands it on.
  void complete_one() {
    for (int ms = 0; ms < 2000; ++ms) {
      if (std::optional<Completion> done = completions.try_pop()) {
        return hub->complete(std::move(*done));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "nothing comes from the encode stage";
  }
  /// Returns the codec of the only message, which must be a tile; its planes must decode to its
  /// hash.
  TileCodec came(SessionId id) {
    const std::vector<Message> messages = drain(id);
    EXPECT_EQ(messages.size(), 1u);
    if (messages.size() != 1 || !messages[0].body.AsTileReply()) return static_cast<TileCodec>(99);
    const wire::TileReplyT& reply = *messages[0].body.AsTileReply();
    EXPECT_EQ(reply.request_id, request);
    const auto codec = static_cast<TileCodec>(reply.codec);
    Tile tile = tile_from_fields(reply).take();
    const Bytes& planes = messages[0].payload;
    EXPECT_TRUE(decode_tile_planes(planes.data(), planes.size(), codec, tile));
    EXPECT_EQ(tile_content_hash(tile), reply.content_hash);
    return codec;
  }

  BoundedQueue<Completion>& completions = queues.completions;
  EncodeStage encode{queues, [] {}};
  std::uint32_t request = 0;
};

using C = TileCodec;

TEST_F(ServerCodec, WelcomeOffersWhatBothHave) {
  const wire::WelcomeT all = greet({kTileCodecs.begin(), kTileCodecs.end()}).second;
  EXPECT_EQ(all.codec, static_cast<std::uint8_t>(C::kZstd));
  EXPECT_EQ(all.codecs.size(), kTileCodecs.size());
  const wire::WelcomeT some = greet({C::kWebp, C::kZstd}).second;
  EXPECT_EQ(some.codecs, wire_codecs({C::kZstd, C::kWebp}));
  EXPECT_EQ(greet({C::kRaw}).second.codec, static_cast<std::uint8_t>(C::kRaw));
  // Without zstd there is no lossy codec, because tiles without colours come beside them.
  EXPECT_EQ(greet({C::kRaw, C::kWebp}).second.codecs, wire_codecs({C::kRaw}));
  restart_with({C::kWebp, C::kZstd});
  EXPECT_EQ(greet({C::kRaw, C::kZstd, C::kWebp}).second.codec, static_cast<std::uint8_t>(C::kWebp));
}

TEST_F(ServerCodec, WhoTakesOnlyZstdGetsZstdWhateverItAsks) {
  encode.start(scene_, 1);
  const SessionId id = greet({C::kZstd}).first;
  std::uint16_t cell = 0;
  for (const std::optional<C> asked :
       {std::optional<C>(), std::optional<C>(C::kWebp), std::optional<C>(C::kRaw),
        std::optional<C>(static_cast<C>(77))}) {
    ask_in(id, asked, ++cell);
    ASSERT_EQ(draw(), 1u);
    complete_one();
    EXPECT_EQ(came(id), C::kZstd);
  }
}

TEST_F(ServerCodec, EveryCodecComesAsAskedAndIsRenderedOnce) {
  encode.start(scene_, 1);
  const SessionId id = greet({kTileCodecs.begin(), kTileCodecs.end()}).first;
  ask_in(id, C::kWebp);
  ASSERT_EQ(draw(), 1u);
  complete_one();
  EXPECT_EQ(came(id), C::kWebp);
  std::set<C> made = {C::kWebp, C::kZstd};
  for (const C codec : {C::kZstd, C::kRaw, C::kWebp, C::kRaw}) {
    ask_in(id, codec);
    EXPECT_EQ(draw(), 0u) << "rendered again for " << codec_name(codec);
    if (made.insert(codec).second) complete_one();
    EXPECT_EQ(came(id), codec);
  }
  EXPECT_EQ(counters.tiles_rendered, 1u);
  EXPECT_EQ(counters.forms_made, 1u) << "raw; webp and zstd came with the first";
}

TEST_F(ServerCodec, TwoWhoMergeGetTheirOwnForms) {
  encode.start(scene_, 1);
  const SessionId a = greet({kTileCodecs.begin(), kTileCodecs.end()}).first;
  const SessionId b = greet({C::kZstd}).first;
  ask_in(a, C::kRaw);
  const std::uint32_t first = request;
  ask_in(b, {});
  EXPECT_EQ(draw(), 1u);
  complete_one();
  EXPECT_EQ(drain(b).size(), 0u) << "its form is being made";
  complete_one();
  EXPECT_EQ(came(b), C::kZstd);
  request = first;
  EXPECT_EQ(came(a), C::kRaw);
  EXPECT_EQ(counters.tiles_rendered, 1u);
}

TEST_F(ServerCodec, TilesWithoutColoursComeInZstd) {
  encode.start(scene_, 1);
  const SessionId id = greet({kTileCodecs.begin(), kTileCodecs.end()}).first;
  ask_in(id, C::kWebp, 0, kCasterTile);
  ASSERT_EQ(draw(), 1u);
  complete_one();
  EXPECT_EQ(came(id), C::kZstd);
  ask_in(id, C::kWebp, 0, kCasterTile);
  EXPECT_EQ(came(id), C::kZstd) << "at once: there is no form of it to be made";
}

// The encode stage is busy (it does not run here), so stored tiles are sent in the form they have.
TEST_F(ServerCodec, BusyEncodersCostNoTile) {
  const SessionId id = greet({kTileCodecs.begin(), kTileCodecs.end()}).first;
  ask_in(id, C::kZstd);
  ASSERT_EQ(draw(), 1u);
  const auto rendered = std::get<RenderedTile>(*encode_jobs.pop());
  const TileId tile = rendered.job.id;
  const StoredTilePtr zstd = encode_tile(rendered, scene_->objects[0], C::kZstd);
  store.put(tile, C::kZstd, zstd);
  hub->complete(FinishedTile{tile, C::kZstd, zstd, zstd});
  EXPECT_EQ(came(id), C::kZstd);
  for (EncodeJob busy; encode_jobs.try_push(busy);) busy = {};
  ask_in(id, C::kWebp);
  EXPECT_EQ(came(id), C::kZstd);
  // A client that does not take that form must ask again.
  const SessionId raw = greet({C::kRaw}).first;
  ask_in(raw, {});
  const std::vector<Message> refused = drain(raw);
  ASSERT_EQ(refused.size(), 1u);
  ASSERT_TRUE(refused[0].body.AsRefused());
  EXPECT_EQ(refused[0].body.AsRefused()->reason, wire::RefusalReason::Busy);
  while (encode_jobs.try_pop()) {
  }
}

TEST_F(ServerCodec, ReplyTellsHowLongTheServerHadIt) {
  encode.start(scene_, 1);
  const SessionId id = greet({C::kZstd}).first;
  ask_in(id, {});
  draw();
  clock.advance_to_us(clock.now_us() + 7000);
  complete_one();
  EXPECT_EQ(drain(id).at(0).body.AsTileReply()->server_us, 7000u);
  ask_in(id, {});
  EXPECT_EQ(drain(id).at(0).body.AsTileReply()->server_us, 0u) << "from the store, at once";
}

TEST(FormRequests, AsManyMayWaitAgainAsWereServed) {
  BoundedQueue<EncodeJob> jobs{1};
  FormRequests forms(jobs);
  const auto tile = std::make_shared<const StoredTile>();
  Waiter waiter;
  waiter.codec = C::kRaw;
  std::size_t first = 0;
  for (const int round : {1, 2}) {
    std::size_t waiting = 0;
    while (waiting < 200'000 && forms.wait({1, 2}, tile, waiter)) ++waiting;
    EXPECT_GT(waiting, 1000u) << "one job serves all of them";
    EXPECT_LT(waiting, 200'000u) << "there is a limit";
    if (round == 1) first = waiting;
    EXPECT_EQ(waiting, first);
    EXPECT_EQ(forms.take_waiting({1, 2}, C::kRaw).size(), waiting);
    EXPECT_TRUE(jobs.try_pop());
  }
}

TEST(FormRequests, WaitersForAnotherFormStay) {
  BoundedQueue<EncodeJob> jobs{4};
  FormRequests forms(jobs);
  const auto tile = std::make_shared<const StoredTile>();
  Waiter raw, webp;
  raw.codec = C::kRaw;
  webp.codec = C::kWebp;
  EXPECT_TRUE(forms.wait({1, 2}, tile, raw) && forms.wait({1, 2}, tile, webp));
  EXPECT_EQ(forms.take_waiting({1, 2}, C::kRaw).size(), 1u);
  EXPECT_EQ(forms.take_waiting({1, 2}, C::kRaw).size(), 0u);
  EXPECT_EQ(forms.take_waiting({1, 2}, C::kWebp).size(), 1u);
}

}  // namespace
}  // namespace mirage::test
