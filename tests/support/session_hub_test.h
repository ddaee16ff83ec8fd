#pragma once
// Session hub test: a hub of sessions without sockets, on a small scene; what clients say to it,
// and what they get.

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "server/prepare/prepared_scene.h"
#include "server/session/session.h"
#include "server/tile/stage_queues.h"
#include "tests/support/protocol_samples.h"

namespace mirage::test {

inline std::vector<std::uint8_t> wire_codecs(const std::vector<TileCodec>& codecs) {
  std::vector<std::uint8_t> out;
  for (const TileCodec codec : codecs) out.push_back(static_cast<std::uint8_t>(codec));
  return out;
}

class SessionHubTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { scene_ = *load_scene("builtin:knot?tubular=16&radial=8"); }
  static void TearDownTestSuite() { scene_.reset(); }
  SessionHubTest() { restart({}); }

  void restart(SessionOptions options, std::shared_ptr<const PreparedScene> scene = scene_) {
    hub = std::make_unique<SessionHub>(std::move(scene), std::move(options), queues);
  }
  static wire::HelloT hello(const std::vector<TileCodec>& codecs = {TileCodec::kRaw,
                                                                    TileCodec::kZstd}) {
    wire::HelloT m;
    m.version_min = m.version_max = limits::kProtocolVersion;
    m.codecs = wire_codecs(codecs);
    return m;
  }
  template <typename BodyT>
  Result<void> send(SessionId id, BodyT&& body) {
    const Bytes bytes = encode_message(std::forward<BodyT>(body));
    return hub->receive(id, bytes.data(), bytes.size());
  }
  /// Returns everything that the session may be sent now.
  std::vector<Message> drain(SessionId id) {
    std::vector<Message> out;
    PacketAssembler assembler(limits::kMaxTransferBytes);
    while (const PacketPtr packet = hub->next_packet(id)) {
      EXPECT_LE(packet->size(), limits::kMaxMessageBytes);
      auto whole = assembler.accept(packet->data(), packet->size());
      EXPECT_TRUE(whole);
      if (!whole || !whole->has_value()) continue;
      auto message = decode_message((*whole)->data(), (*whole)->size());
      EXPECT_TRUE(message);
      if (message) out.push_back(message.take());
    }
    return out;
  }
  SessionId greeted() {
    const SessionId id = hub->open();
    EXPECT_TRUE(send(id, hello()).ok());
    drain(id);
    return id;
  }
  static wire::Ask ask(std::uint32_t request, std::uint16_t x = 0, std::uint8_t size_class = 2,
                       std::uint8_t channels = kLitTile) {
    return wire::Ask(request, 0, 0, 1.0f, 0, 8, x, 0, 9, 2, size_class, channels, 0);
  }
  Result<void> send_ask(SessionId id, const wire::Ask& one) {
    wire::RequestBatchT batch;
    batch.asks = {one};
    batch.credit_bytes = 1 << 30;
    return send(id, std::move(batch));
  }
  /// Returns the reason of the only message, a refusal; None: it is something else.
  wire::RefusalReason refusal(SessionId id) {
    const std::vector<Message> messages = drain(id);
    if (messages.size() != 1 || !messages[0].body.AsRefused()) return wire::RefusalReason::None;
    return messages[0].body.AsRefused()->reason;
  }
  /// Returns the tiles that the GL thread would render next; empty: none.
  std::vector<TileJob> take_tiles() {
    auto work = queue.take({[](std::uint32_t) { return true; }}, false);
    return work ? std::get<std::vector<TileJob>>(std::move(*work)) : std::vector<TileJob>{};
  }
  /// Finishes everything that is queued, with tiles of `bytes` of payload.
  std::size_t render_all(std::size_t bytes = 100) {
    const std::vector<TileJob> jobs = take_tiles();
    for (const TileJob& job : jobs) {
      auto tile = std::make_shared<StoredTile>();
      tile->reply = sample_tile_reply();
      tile->planes.resize(bytes);
      store.put(job.id, TileCodec::kZstd, tile);
      hub->complete(FinishedTile{job.id, TileCodec::kZstd, tile, tile});
    }
    return jobs.size();
  }

  static inline std::shared_ptr<const PreparedScene> scene_;
  VirtualClock clock;
  StageQueues queues{clock, 1 << 24, {}};
  Counters& counters = queues.counters;
  TileQueue& queue = queues.tiles;
  TileStore& store = queues.store;
  BoundedQueue<EncodeJob>& encode_jobs = queues.rendered;
  BoundedQueue<ImageLevel>& image_jobs = queues.images;
  std::unique_ptr<SessionHub> hub;
};

}  // namespace mirage::test
