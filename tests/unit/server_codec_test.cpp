// Codecs of tiles, from the hello to the reply: what both ends have, what a batch asks for, forms
// made of what is there.
#include <gtest/gtest.h>

#include <set>

#include "server/encode_stage.h"
#include "server/session.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kEdge = 23;  // of size class 1

std::vector<std::uint8_t> wire_codecs(const std::vector<TileCodec>& codecs) {
  std::vector<std::uint8_t> out;
  for (const TileCodec codec : codecs) out.push_back(static_cast<std::uint8_t>(codec));
  return out;
}

// A hub with the shipped encode stage behind it; only the drawing is made up.
class ServerCodec : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { scene_ = *load_scene("builtin:knot?tubular=16&radial=8"); }
  static void TearDownTestSuite() { scene_.reset(); }
  ServerCodec() { restart({}); }
  ~ServerCodec() override {
    jobs.close();
    encode.join();
  }
  void restart(std::vector<TileCodec> codecs) {
    SessionOptions options;
    options.shadows = true;
    if (!codecs.empty()) options.codecs = std::move(codecs);
    hub = std::make_unique<SessionHub>(scene_, std::move(options), clock, counters, queue, store,
                                       jobs, images);
  }
  std::vector<Message> drain(SessionId id) {
    std::vector<Message> out;
    while (const FramePtr frame = hub->next_frame(id)) {
      out.push_back(decode_message(frame->data(), frame->size()).take());
    }
    return out;
  }
  /// Greets with these codecs; the welcome.
  std::pair<SessionId, wire::WelcomeT> greet(const std::vector<TileCodec>& codecs) {
    const SessionId id = hub->open().take();
    wire::HelloT hello;
    hello.version_min = hello.version_max = limits::kProtocolVersion;
    hello.codecs = wire_codecs(codecs);
    const Bytes bytes = encode_message(std::move(hello));
    EXPECT_TRUE(hub->receive(id, bytes.data(), bytes.size()).ok());
    return {id, *drain(id).at(0).body.AsWelcome()};
  }
  void ask(SessionId id, std::optional<TileCodec> codec, std::uint16_t cell = 0,
           std::uint8_t channels = kLitTile) {
    wire::RequestBatchT batch;
    batch.asks = {wire::Ask(++request, 0, 0, 1.0f, 0, 8, cell, 0, 9, 2, 1, channels, 0)};
    batch.credit_bytes = 1 << 30;
    if (codec) batch.codec = static_cast<std::uint8_t>(*codec);
    const Bytes bytes = encode_message(std::move(batch));
    EXPECT_TRUE(hub->receive(id, bytes.data(), bytes.size()).ok());
  }
  /// Draws what is queued; how many tiles it were.
  std::size_t draw() {
    const auto work = queue.take([](std::uint32_t) { return true; }, false);
    if (!work) return 0;
    const auto& tiles = std::get<std::vector<TileJob>>(*work);
    for (const TileJob& job : tiles) {
      ++counters.tiles_rendered;
      auto page = std::make_shared<PagePixels>();
      page->width = page->height = static_cast<int>(kEdge);
      for (std::uint32_t i = 0; i < kEdge * kEdge; ++i) {
        const std::uint32_t grain = (i * 2654435761u >> 24) % 16;  // or zstd is as small as any
        for (const std::uint32_t c : {60 + grain, 90 + i / 8 + grain / 2, 200 - grain, 255u}) {
          page->rgba.push_back(static_cast<std::uint8_t>(c));
        }
        page->depth.push_back(static_cast<std::uint8_t>(100 + i % 9));
      }
      EncodeJob encode_job;
      encode_job.rendered = std::make_shared<RenderedTile>(RenderedTile{job, page, 0, 0, 0, 0});
      jobs.push(std::move(encode_job));
    }
    return tiles.size();
  }
  /// Waits for the next of the encode stage's completions and hands it on.
  void complete_one() { hub->complete(*completions.pop()); }
  /// The codec of the only message, which must be a tile; its planes must decode to its hash.
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

  static std::shared_ptr<const PreparedScene> scene_;
  VirtualClock clock;
  Counters counters;
  TileQueue queue{clock, counters};
  TileStore store{1 << 24, nullptr, counters};
  BoundedQueue<EncodeJob> jobs{4};
  BoundedQueue<ImageLevel> images{4};
  BoundedQueue<Completion> completions{64};
  EncodeStage encode{jobs, completions, store, counters, [] {}};
  std::unique_ptr<SessionHub> hub;
  std::uint32_t request = 0;
};
std::shared_ptr<const PreparedScene> ServerCodec::scene_;

using C = TileCodec;

TEST_F(ServerCodec, WelcomeOffersWhatBothHave) {
  const wire::WelcomeT all = greet({kTileCodecs.begin(), kTileCodecs.end()}).second;
  EXPECT_EQ(all.codec, static_cast<std::uint8_t>(C::kZstd));
  EXPECT_EQ(all.codecs.size(), kTileCodecs.size());
  const wire::WelcomeT some = greet({C::kWebp, C::kZstd}).second;
  EXPECT_EQ(some.codecs, wire_codecs({C::kZstd, C::kWebp}));
  EXPECT_EQ(greet({C::kRaw}).second.codec, static_cast<std::uint8_t>(C::kRaw));
  // Without zstd no lossy codec: tiles without colours come beside them.
  EXPECT_EQ(greet({C::kRaw, C::kWebp}).second.codecs, wire_codecs({C::kRaw}));
  restart({C::kWebp, C::kZstd});
  EXPECT_EQ(greet({C::kRaw, C::kZstd, C::kWebp}).second.codec, static_cast<std::uint8_t>(C::kWebp));
}

TEST_F(ServerCodec, WhoTakesOnlyZstdGetsZstdWhateverItAsks) {
  encode.start(scene_, 1);
  const SessionId id = greet({C::kZstd}).first;
  std::uint16_t cell = 0;
  for (const std::optional<C> asked :
       {std::optional<C>(), std::optional<C>(C::kWebp), std::optional<C>(C::kLz4),
        std::optional<C>(static_cast<C>(77))}) {
    ask(id, asked, ++cell);
    ASSERT_EQ(draw(), 1u);
    complete_one();
    EXPECT_EQ(came(id), C::kZstd);
  }
}

TEST_F(ServerCodec, EveryCodecComesAsAskedAndIsRenderedOnce) {
  encode.start(scene_, 1);
  const SessionId id = greet({kTileCodecs.begin(), kTileCodecs.end()}).first;
  ask(id, C::kWebp);
  ASSERT_EQ(draw(), 1u);
  complete_one();
  EXPECT_EQ(came(id), C::kWebp);
  std::set<C> made = {C::kWebp, C::kZstd};
  for (const C codec : {C::kZstd, C::kLz4, C::kBc3, C::kRaw, C::kBc3, C::kWebp, C::kLz4}) {
    ask(id, codec);
    EXPECT_EQ(draw(), 0u) << "rendered again for " << codec_name(codec);
    if (made.insert(codec).second) complete_one();
    EXPECT_EQ(came(id), codec);
  }
  EXPECT_EQ(counters.tiles_rendered, 1u);
  EXPECT_EQ(counters.forms_made, 3u) << "lz4, bc3, raw; webp and zstd came with the first";
}

TEST_F(ServerCodec, TwoWhoMergeGetTheirOwnForms) {
  encode.start(scene_, 1);
  const SessionId a = greet({kTileCodecs.begin(), kTileCodecs.end()}).first;
  const SessionId b = greet({C::kZstd}).first;
  ask(a, C::kLz4);
  const std::uint32_t first = request;
  ask(b, {});
  EXPECT_EQ(draw(), 1u);
  complete_one();
  EXPECT_EQ(drain(b).size(), 0u) << "its form is being made";
  complete_one();
  EXPECT_EQ(came(b), C::kZstd);
  request = first;
  EXPECT_EQ(came(a), C::kLz4);
  EXPECT_EQ(counters.tiles_rendered, 1u);
}

TEST_F(ServerCodec, TilesWithoutColoursComeInZstd) {
  encode.start(scene_, 1);
  const SessionId id = greet({kTileCodecs.begin(), kTileCodecs.end()}).first;
  ask(id, C::kWebp, 0, kCasterTile);
  ASSERT_EQ(draw(), 1u);
  complete_one();
  EXPECT_EQ(came(id), C::kZstd);
}

// The encode stage has enough to do (it does not run here): what is there is sent as it is.
TEST_F(ServerCodec, BusyEncodersCostNoTile) {
  const SessionId id = greet({kTileCodecs.begin(), kTileCodecs.end()}).first;
  ask(id, C::kZstd);
  ASSERT_EQ(draw(), 1u);
  const EncodeJob job = *jobs.pop();
  const TileId tile = job.rendered->job.id;
  const StoredTilePtr zstd = EncodeStage::encode(*job.rendered, scene_->objects[0], C::kZstd);
  store.put(tile, C::kZstd, zstd);
  hub->complete({tile, zstd, std::nullopt, 0, {}, C::kZstd, zstd});
  EXPECT_EQ(came(id), C::kZstd);
  while (jobs.size() < 4) jobs.push({});
  ask(id, C::kWebp);
  EXPECT_EQ(came(id), C::kZstd);
  // One who does not take that form is to ask again.
  const SessionId raw = greet({C::kRaw}).first;
  ask(raw, {});
  const std::vector<Message> refused = drain(raw);
  ASSERT_EQ(refused.size(), 1u);
  ASSERT_TRUE(refused[0].body.AsRefused());
  EXPECT_EQ(refused[0].body.AsRefused()->reason, wire::RefusalReason::Busy);
  while (jobs.try_pop()) {
  }
}

TEST_F(ServerCodec, ReplyTellsHowLongTheServerHadIt) {
  encode.start(scene_, 1);
  const SessionId id = greet({C::kZstd}).first;
  ask(id, {});
  draw();
  clock.advance_to_us(clock.now_us() + 7000);
  complete_one();
  EXPECT_EQ(drain(id).at(0).body.AsTileReply()->server_us, 7000u);
  ask(id, {});
  EXPECT_EQ(drain(id).at(0).body.AsTileReply()->server_us, 0u) << "from the store, at once";
}

}  // namespace
}  // namespace mirage::test
