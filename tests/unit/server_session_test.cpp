// Sessions without sockets: greeting, asks, credit, refusals, hostile bytes.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "server/image_stage.h"
#include "server/session.h"
#include "tests/unit/protocol_samples.h"

namespace mirage::test {
namespace {

class ServerSession : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { scene_ = *load_scene("builtin:knot?tubular=16&radial=8"); }
  static void TearDownTestSuite() { scene_.reset(); }
  ServerSession() { restart({}); }

  void restart(SessionOptions options) {
    hub = std::make_unique<SessionHub>(scene_, std::move(options), clock, counters, queue, store,
                                       encode_jobs, image_jobs);
  }
  static wire::HelloT hello() {
    wire::HelloT m;
    m.version_min = m.version_max = limits::kProtocolVersion;
    m.codecs = {static_cast<std::uint8_t>(TileCodec::kRaw),
                static_cast<std::uint8_t>(TileCodec::kZstd)};
    return m;
  }
  template <typename BodyT>
  Result<void> send(SessionId id, BodyT&& body) {
    const Bytes bytes = encode_message(std::forward<BodyT>(body));
    return hub->receive(id, bytes.data(), bytes.size());
  }
  /// Everything the session may be sent now.
  std::vector<Message> drain(SessionId id) {
    std::vector<Message> out;
    FrameAssembler assembler(limits::kMaxTransferBytes);
    while (const FramePtr frame = hub->next_frame(id)) {
      EXPECT_LE(frame->size(), limits::kMaxMessageBytes);
      auto whole = assembler.accept(frame->data(), frame->size());
      EXPECT_TRUE(whole);
      if (!whole || !whole->has_value()) continue;
      auto message = decode_message((*whole)->data(), (*whole)->size());
      EXPECT_TRUE(message);
      if (message) out.push_back(message.take());
    }
    return out;
  }
  SessionId greeted() {
    const SessionId id = hub->open().take();
    EXPECT_TRUE(send(id, hello()).ok());
    drain(id);
    return id;
  }
  static wire::Ask ask(std::uint32_t request, std::uint16_t x = 0, std::uint8_t size_class = 2) {
    return wire::Ask(request, 0, 0, 1.0f, 0, 8, x, 0, 9, 2, size_class,
                     kChannelColor | kChannelDepth, 0);
  }
  Result<void> send_ask(SessionId id, const wire::Ask& one) {
    wire::RequestBatchT batch;
    batch.asks = {one};
    batch.credit_bytes = 1 << 30;
    return send(id, std::move(batch));
  }
  /// The only message, which must refuse.
  wire::RefusalReason refusal(SessionId id) {
    const std::vector<Message> messages = drain(id);
    if (messages.size() != 1 || !messages[0].body.AsRefused()) return wire::RefusalReason::None;
    return messages[0].body.AsRefused()->reason;
  }
  /// Finishes all that is queued with tiles of `bytes` of payload.
  std::size_t render_all(std::size_t bytes = 100) {
    const auto work = queue.take([](std::uint32_t) { return true; }, false);
    if (!work) return 0;
    const auto& jobs = std::get<std::vector<TileJob>>(*work);
    for (const TileJob& job : jobs) {
      auto tile = std::make_shared<StoredTile>();
      tile->reply = sample_tile_reply();
      tile->planes.resize(bytes);
      store.put(job.id, TileCodec::kZstd, tile);
      hub->complete({job.id, tile, std::nullopt, 0, {}, TileCodec::kZstd, tile});
    }
    return jobs.size();
  }

  static std::shared_ptr<const PreparedScene> scene_;
  VirtualClock clock;
  Counters counters;
  TileQueue queue{clock, counters};
  TileStore store{1 << 24, nullptr, counters};
  BoundedQueue<EncodeJob> encode_jobs{16};
  BoundedQueue<ImageLevel> image_jobs{16};
  std::unique_ptr<SessionHub> hub;
};
std::shared_ptr<const PreparedScene> ServerSession::scene_;

TEST_F(ServerSession, HelloIsAnsweredWithTheScene) {
  const SessionId id = hub->open().take();
  EXPECT_FALSE(hub->next_frame(id)) << "nothing before the hello";
  ASSERT_TRUE(send(id, hello()).ok());
  EXPECT_EQ(hub->take_writable(), std::set<SessionId>{id});
  const std::vector<Message> messages = drain(id);
  ASSERT_EQ(messages.size(), 3u);
  const wire::WelcomeT* welcome = messages[0].body.AsWelcome();
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->version, limits::kProtocolVersion);
  EXPECT_EQ(welcome->revision, scene_->revision);
  EXPECT_EQ(welcome->objects, 1u);
  EXPECT_EQ(welcome->instances, 1u);
  ASSERT_TRUE(messages[1].body.AsObjectPage());
  EXPECT_EQ(messages[1].body.AsObjectPage()->objects[0]->radius, scene_->objects[0].radius);
  ASSERT_TRUE(messages[2].body.AsInstancePage());
  EXPECT_EQ(messages[2].body.AsInstancePage()->instances.size(), 1u);
}

TEST_F(ServerSession, MembersComeAfterTheDescriptionAndBeforeTiles) {
  const SessionId id = hub->open().take();
  ASSERT_TRUE(send(id, hello()).ok());
  ASSERT_TRUE(send(id, sample_open_request()).ok());
  const std::vector<Message> messages = drain(id);
  ASSERT_EQ(messages.size(), 4u);
  const wire::InstancePageT* told = messages[2].body.AsInstancePage();
  ASSERT_TRUE(told);
  EXPECT_EQ(told->request_id, 0u);
  EXPECT_TRUE(told->last);
  const wire::InstancePageT* answer = messages[3].body.AsInstancePage();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->request_id, sample_open_request().request_id);
  EXPECT_TRUE(answer->last) << "an answer ends, also one that tells nothing";
}

TEST_F(ServerSession, WhatComesBeforeTheHelloIsAnError) {
  for (const Bytes& bytes : sample_messages()) {
    const bool is_hello = decode_message(bytes.data(), bytes.size())->body.AsHello() != nullptr;
    if (is_hello) continue;
    const SessionId id = hub->open().take();
    const Result<void> result = hub->receive(id, bytes.data(), bytes.size());
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().id, ErrorId::kWireState);
  }
}

TEST_F(ServerSession, MessagesOfAServerAreNotForAServer) {
  for (const Bytes& bytes : sample_messages()) {
    const auto type = decode_message(bytes.data(), bytes.size())->body.type;
    if (type == wire::Body::RequestBatch || type == wire::Body::SetLighting ||
        type == wire::Body::ReferenceRequest || type == wire::Body::StatsRequest ||
        type == wire::Body::OpenRequest) {
      continue;
    }
    const SessionId id = greeted();
    const Result<void> result = hub->receive(id, bytes.data(), bytes.size());
    ASSERT_FALSE(result);
    const bool bye = type == wire::Body::Bye;
    EXPECT_EQ(result.error().id, bye ? ErrorId::kNetworkClosed : ErrorId::kWireState);
  }
}

TEST_F(ServerSession, BadHellos) {
  SessionOptions options;
  options.token = "secret";
  restart(options);
  const auto error_of = [&](const std::function<void(wire::HelloT&)>& change) {
    wire::HelloT m = hello();
    m.token = "secret";
    change(m);
    const Result<void> result = send(hub->open().take(), std::move(m));
    return result ? std::string() : std::string(error_name(result.error().id));
  };
  EXPECT_EQ(error_of([](wire::HelloT&) {}), "");
  EXPECT_EQ(error_of([](wire::HelloT& m) { m.version_min = m.version_max = 99; }), "wire-version");
  EXPECT_EQ(error_of([](wire::HelloT& m) { m.version_min = m.version_max = 0; }), "wire-version");
  EXPECT_EQ(error_of([](wire::HelloT& m) { m.version_max = 99; }), "") << "a range with ours in it";
  for (const char* token : {"", "Secret", "secre", "secrets", "secretsecret", "s"}) {
    EXPECT_EQ(error_of([&](wire::HelloT& m) { m.token = token; }), "auth") << token;
  }
  EXPECT_EQ(error_of([](wire::HelloT& m) { m.codecs = {77, 3}; }), "codec");
  EXPECT_EQ(error_of([](wire::HelloT& m) { m.codecs.clear(); }), "codec");
}

TEST_F(ServerSession, TooManyClients) {
  SessionOptions options;
  options.max_clients = 2;
  restart(options);
  const SessionId first = hub->open().take();
  ASSERT_TRUE(hub->open());
  const auto third = hub->open();
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().id, ErrorId::kBusy);
  hub->close(first);
  EXPECT_TRUE(hub->open());
}

TEST_F(ServerSession, AsksAreQueuedAndAnswered) {
  const SessionId a = greeted(), b = greeted();
  ASSERT_TRUE(send_ask(a, ask(11)).ok());
  ASSERT_TRUE(send_ask(b, ask(22)).ok());
  EXPECT_EQ(queue.length(), 1u) << "one key, one job";
  EXPECT_EQ(render_all(), 1u);
  for (const auto& [id, request] : {std::pair{a, 11u}, std::pair{b, 22u}}) {
    const std::vector<Message> messages = drain(id);
    ASSERT_EQ(messages.size(), 1u);
    EXPECT_EQ(messages[0].body.AsTileReply()->request_id, request);
  }
  ASSERT_TRUE(send_ask(a, ask(12)).ok());
  EXPECT_EQ(queue.length(), 0u) << "from the store";
  ASSERT_EQ(drain(a).size(), 1u);
}

TEST_F(ServerSession, BadKeysAreRefusedNotFatal) {
  using R = wire::RefusalReason;
  const SessionId id = greeted();
  const auto refused = [&](wire::Ask one) {
    EXPECT_TRUE(send_ask(id, one).ok());
    return refusal(id);
  };
  const auto changed = [](std::uint32_t instance, std::uint32_t object, std::int32_t distance,
                          std::uint16_t x, std::uint8_t level, std::uint8_t distance_level,
                          std::uint8_t size, std::uint8_t channels) {
    return wire::Ask(1, instance, object, 1.0f, 0, distance, x, 0, level, distance_level, size,
                     channels, 0);
  };
  EXPECT_EQ(refused(changed(0, 1, 8, 0, 9, 2, 2, 3)), R::UnknownObject);
  EXPECT_EQ(refused(changed(1, 0, 8, 0, 9, 2, 2, 3)), R::UnknownObject);
  EXPECT_EQ(refused(changed(UINT32_MAX, UINT32_MAX, 8, 0, 9, 2, 2, 3)), R::UnknownObject);
  EXPECT_EQ(refused(changed(0, 0, INT32_MAX, 0, 9, 2, 2, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, INT32_MIN, 0, 9, 2, 2, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, -8, 0, 9, 2, 2, 3)), R::BadKey) << "inside the ball";
  EXPECT_EQ(refused(changed(0, 0, 8, 512, 9, 2, 2, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, 8, 0, 17, 2, 2, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, 8, 0, 9, 255, 2, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, 8, 0, 9, 2, 15, 3)), R::BadKey);
  EXPECT_EQ(refused(changed(0, 0, 8, 0, 9, 2, 2, 7)), R::BadKey);
  EXPECT_EQ(queue.length(), 0u);
  wire::RequestBatchT batch;
  batch.lighting_id = 5;  // never set
  batch.asks = {ask(1)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  EXPECT_EQ(refusal(id), R::BadKey);
}

TEST_F(ServerSession, PhasesBelongToMovingObjectsOnly) {
  using R = wire::RefusalReason;
  const auto with_phase = [](std::uint32_t request, std::uint16_t phase) {
    return wire::Ask(request, 0, 0, 1.0f, 0, 8, 0, 0, 9, 2, 2, 3, phase);
  };
  const SessionId still = greeted();
  ASSERT_TRUE(send_ask(still, with_phase(1, 1)).ok());
  EXPECT_EQ(refusal(still), R::BadKey);

  auto moving = std::make_shared<PreparedScene>(*scene_);
  moving->objects[0].motion.clip_s = 2;
  moving->objects[0].motion.speed.assign(limits::kMotionSegments, 1.0f);
  hub = std::make_unique<SessionHub>(moving, SessionOptions{}, clock, counters, queue, store,
                                     encode_jobs, image_jobs);
  const SessionId id = greeted();
  for (const Phase phase : std::initializer_list<Phase>{0, 257, 65535}) {
    ASSERT_TRUE(send_ask(id, with_phase(2, phase)).ok());
    EXPECT_EQ(refusal(id), R::BadKey) << phase;
  }
  for (const Phase phase : std::initializer_list<Phase>{1, 2, 256}) {
    ASSERT_TRUE(send_ask(id, with_phase(phase, phase)).ok());
  }
  EXPECT_EQ(queue.length(), 3u) << "each phase is a tile of its own";
}

TEST_F(ServerSession, CreditHoldsTilesBack) {
  const SessionId id = greeted();
  const auto request = [&](std::vector<wire::Ask> asks, std::uint64_t credit) {
    wire::RequestBatchT batch;
    batch.asks = std::move(asks);
    batch.credit_bytes = credit;
    ASSERT_TRUE(send(id, std::move(batch)).ok());
  };
  request({ask(1, 1), ask(2, 2), ask(3, 3), ask(4, 4)}, 0);
  EXPECT_EQ(render_all(10'000), 4u);
  EXPECT_TRUE(drain(id).empty());
  request({}, 1);
  EXPECT_EQ(drain(id).size(), 1u) << "begun is finished";
  request({}, 25'000);
  EXPECT_EQ(drain(id).size(), 2u);
  request({}, 1);  // credit never falls
  EXPECT_TRUE(drain(id).empty());
  send(id, sample_stats_request()).ok();
  EXPECT_EQ(drain(id).size(), 1u) << "control needs none";
  request({}, 1'000'000);
  EXPECT_EQ(drain(id).size(), 1u);
}

TEST_F(ServerSession, ATileCostsNoMoreCreditThanTheClientCounts) {
  // The client counts so many bytes a tile; were it less than here, a session would dry up one day.
  const SessionId id = greeted();
  std::uint16_t n = 0;
  for (const std::size_t payload : {0, 1000, 131'072, 400'000, 3'000'000}) {
    ASSERT_TRUE(send_ask(id, ask(n, n)).ok());
    ++n;
    render_all(payload);
    std::size_t sent = 0;
    while (const FramePtr frame = hub->next_frame(id)) sent += frame->size();
    EXPECT_GT(sent, payload);
    EXPECT_LE(sent, payload + 192 + payload / 4096);
  }
}

TEST_F(ServerSession, EveryByteSentIsCounted) {
  const SessionId id = hub->open().take();
  ASSERT_TRUE(send(id, hello()).ok());
  std::size_t sent = 0;
  while (const FramePtr frame = hub->next_frame(id)) sent += frame->size();
  EXPECT_GT(sent, 0u);
  EXPECT_EQ(counters.bytes_sent, sent);
}

TEST_F(ServerSession, GeometryAndReferenceCanBeOff) {
  SessionOptions options;
  options.geometry = options.reference = false;
  restart(options);
  const SessionId id = greeted();
  wire::RequestBatchT batch;
  batch.mesh_asks = {wire::MeshAsk(7, 0, 0)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::NoGeometry);
  ASSERT_TRUE(send(id, sample_reference_request()).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::NoReference);
}

TEST_F(ServerSession, GeometryComesByLevel) {
  const SessionId id = greeted();
  const auto levels = static_cast<std::uint8_t>(scene_->objects[0].lods.size());
  ASSERT_GE(levels, 1);
  const auto last = static_cast<std::uint8_t>(levels - 1);
  wire::RequestBatchT batch;
  batch.mesh_asks = {wire::MeshAsk(1, 0, last), wire::MeshAsk(2, 1, 0),
                     wire::MeshAsk(3, 0, levels)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  const std::vector<Message> messages = drain(id);
  ASSERT_EQ(messages.size(), 3u);
  EXPECT_EQ(messages[0].body.AsRefused()->reason, wire::RefusalReason::UnknownObject);
  EXPECT_EQ(messages[0].body.AsRefused()->request_id, 2u);
  EXPECT_EQ(messages[1].body.AsRefused()->request_id, 3u);
  const wire::MeshReplyT* mesh = messages[2].body.AsMeshReply();
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->request_id, 1u);
  EXPECT_EQ(mesh->lod, last);
  const Bytes& payload = messages[2].payload;
  EXPECT_EQ(payload.size(), scene_->objects[0].lods[last].bytes);
  const auto raw = mesh->raw_bytes == payload.size()
                       ? Result<Bytes>(payload)
                       : decompress_block(payload.data(), payload.size(), mesh->raw_bytes);
  ASSERT_TRUE(raw);
  const auto model = decode_model(raw->data(), raw->size(), scene_->images.size());
  ASSERT_TRUE(model);
  EXPECT_EQ(model->mesh.indices.size() / 3, scene_->objects[0].lods[last].triangles);
}

TEST_F(ServerSession, ImagesAreEncodedOnceForAll) {
  scene_ = *load_scene("builtin:forest?trees=4&clutter=1");
  restart({});
  const SessionId first = greeted(), second = greeted();
  wire::RequestBatchT batch;
  batch.image_asks = {wire::ImageAsk(5, 0, 1)};
  ASSERT_TRUE(send(first, wire::RequestBatchT(batch)).ok());
  batch.image_asks[0] = wire::ImageAsk(6, 0, 1);
  ASSERT_TRUE(send(second, wire::RequestBatchT(batch)).ok());
  EXPECT_TRUE(drain(first).empty());
  ASSERT_TRUE(send(second, wire::RequestBatchT(batch)).ok());
  EXPECT_EQ(refusal(second), wire::RefusalReason::Busy) << "it waits for this one already";
  std::optional<ImageLevel> job = image_jobs.try_pop();
  ASSERT_TRUE(job);
  EXPECT_FALSE(image_jobs.try_pop()) << "one job for both";
  Completion done;
  done.image = *job;
  done.message = ImageStage::encode(*scene_, *job);
  const Bytes bytes = done.message;
  hub->complete(std::move(done));
  for (const auto& [id, request] : {std::pair(first, 5u), std::pair(second, 6u)}) {
    const std::vector<Message> messages = drain(id);
    ASSERT_EQ(messages.size(), 1u);
    ASSERT_TRUE(messages[0].body.AsImageReply());
    EXPECT_EQ(messages[0].body.AsImageReply()->request_id, request);
    EXPECT_EQ(messages[0].payload, bytes);
  }
  // Asked for again, it comes from the cache; what is not there is refused.
  batch.image_asks = {wire::ImageAsk(7, 0, 1), wire::ImageAsk(8, 0, 9), wire::ImageAsk(9, 9999, 0)};
  ASSERT_TRUE(send(first, std::move(batch)).ok());
  EXPECT_FALSE(image_jobs.try_pop());
  EXPECT_EQ(drain(first).size(), 3u);
  SetUpTestSuite();
}

TEST_F(ServerSession, StatsTellWhatHappened) {
  const SessionId id = greeted();
  greeted();
  ASSERT_TRUE(send_ask(id, ask(1)).ok());
  ASSERT_TRUE(send(id, sample_stats_request()).ok());
  const std::vector<Message> messages = drain(id);
  ASSERT_EQ(messages.size(), 1u);
  const wire::StatsT* stats = messages[0].body.AsStats();
  ASSERT_TRUE(stats);
  EXPECT_EQ(stats->request_id, 9u);
  EXPECT_EQ(stats->queue_length, 1u);
  EXPECT_EQ(stats->clients, 2u);
}

TEST_F(ServerSession, TheAskTooManyIsBusy) {
  const SessionId id = greeted();
  std::uint32_t request = 0;
  for (int i = 0; i < 4; ++i) {
    wire::RequestBatchT batch;
    for (int k = 0; k < 1024; ++k, ++request) {
      batch.asks.push_back(ask(request, static_cast<std::uint16_t>(request % 512),
                               static_cast<std::uint8_t>(request / 512)));
    }
    ASSERT_TRUE(send(id, std::move(batch)).ok());
  }
  EXPECT_TRUE(drain(id).empty());
  ASSERT_TRUE(send_ask(id, ask(request, 1, 12)).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::Busy);
  const SessionId other = greeted();
  ASSERT_TRUE(send_ask(other, ask(1, 1, 12)).ok());
  EXPECT_TRUE(drain(other).empty());
}

TEST_F(ServerSession, ShadowsBelongToAnInstanceAndALightAndCastersToNeither) {
  const auto of_kind = [](std::uint32_t request, std::uint8_t channels) {
    return wire::Ask(request, 0, 0, 1.0f, 0, 8, 0, 0, 9, 2, 2, channels, 0);
  };
  for (const std::uint8_t kind : {kShadowTile, kCasterTile}) {
    const SessionId id = greeted();
    ASSERT_TRUE(send_ask(id, of_kind(1, kind)).ok());
    EXPECT_EQ(refusal(id), wire::RefusalReason::BadKey) << "without --shadows";
  }
  SessionOptions options;
  options.shadows = true;
  restart(options);
  const SessionId id = greeted();
  ASSERT_TRUE(send_ask(id, of_kind(1, kShadowTile)).ok());
  ASSERT_TRUE(send_ask(id, of_kind(2, kCasterTile)).ok());
  const auto work = queue.take([](std::uint32_t) { return true; }, false);
  ASSERT_TRUE(work);
  const auto& jobs = std::get<std::vector<TileJob>>(*work);
  ASSERT_EQ(jobs.size(), 2u);
  const TileJob& shadow = jobs[jobs[0].key.channels == kShadowTile ? 0 : 1];
  const TileJob& caster = jobs[jobs[0].key.channels == kShadowTile ? 1 : 0];
  EXPECT_EQ(shadow.key.instance, 1u);
  EXPECT_EQ(shadow.key.lighting, lighting_hash(scene_->scene.lighting));
  EXPECT_TRUE(same_lighting(shadow.world, scene_->scene.lighting));
  EXPECT_EQ(caster.key.instance, 0u);
  EXPECT_EQ(caster.key.lighting, 0u);
  wire::SetLightingT dark;
  dark.id = 1;
  dark.lighting = to_wire(Lighting{});
  ASSERT_TRUE(send(id, std::move(dark)).ok());
  wire::RequestBatchT batch;
  batch.lighting_id = 1;
  batch.asks = {of_kind(3, kShadowTile)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  EXPECT_EQ(refusal(id), wire::RefusalReason::BadKey) << "no sun, no shadow";
}

TEST_F(ServerSession, LateAsksAreRefused) {
  const SessionId id = greeted();
  ASSERT_TRUE(send_ask(id, wire::Ask(1, 0, 0, 1.0f, 50, 8, 0, 0, 9, 2, 2, 3, 0)).ok());
  clock.advance_to_us(60'000);
  EXPECT_EQ(render_all(), 0u);
  hub->refuse_late();
  EXPECT_EQ(refusal(id), wire::RefusalReason::Late);
}

TEST_F(ServerSession, HostileBytesHurtOnlyTheirSender) {
  const SessionId good = greeted();
  ASSERT_TRUE(send_ask(good, ask(1)).ok());
  std::mt19937 random(13);
  const std::vector<Bytes> samples = sample_messages();
  int errors = 0;
  for (int i = 0; i < 5000; ++i) {
    const SessionId bad = hub->open().take();
    if (i % 2 == 0) {
      ASSERT_TRUE(send(bad, hello()).ok());
    }
    Bytes bytes = samples[random() % samples.size()];
    for (int k = 0; k < 4; ++k) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    if (i % 3 == 0) bytes.resize(random() % bytes.size());
    if (!hub->receive(bad, bytes.data(), bytes.size())) ++errors;
    drain(bad);
    hub->close(bad);
  }
  EXPECT_GT(errors, 3000);
  EXPECT_EQ(hub->clients(), 1u);
  while (queue.length() > 0) {  // references of the bad ones are gone with them
    ASSERT_GT(render_all(), 0u);
  }
  ASSERT_EQ(drain(good).size(), 1u);
}

TEST_F(ServerSession, CloseDuringRenderingIsHarmless) {
  const SessionId id = greeted();
  ASSERT_TRUE(send_ask(id, ask(1)).ok());
  hub->close(id);
  EXPECT_EQ(render_all(), 0u);
  EXPECT_TRUE(hub->take_writable().empty());
  EXPECT_EQ(queue.length(), 0u);
}

// A batch may ask for far more than a client could ever be allowed to leave unread.
TEST_F(ServerSession, WhoDoesNotReadGetsNoMoreAndIsOverdue) {
  SessionOptions options;
  options.max_outbox_bytes = 3 * scene_->objects[0].lods[0].bytes;
  restart(options);
  const SessionId id = greeted(), other = greeted();
  wire::RequestBatchT batch;
  for (std::uint32_t i = 0; i < limits::kMaxAsksPerBatch; ++i) {
    batch.mesh_asks.emplace_back(i + 1, 0, 0);
  }
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  const auto overdue = hub->overdue();
  ASSERT_EQ(overdue.size(), 1u);
  EXPECT_EQ(overdue[0].first, id);
  EXPECT_EQ(overdue[0].second.id, ErrorId::kBusy);
  EXPECT_LE(drain(id).size(), 3u);
  EXPECT_EQ(hub->overdue().size(), 1u) << "what was left out never comes";
  ASSERT_TRUE(send_ask(other, ask(1)).ok());
  EXPECT_EQ(render_all(), 1u);
  EXPECT_EQ(drain(other).size(), 1u);
}

TEST_F(ServerSession, SilentClientsAreOverdue) {
  const SessionId silent = hub->open().take();
  greeted();
  EXPECT_TRUE(hub->overdue().empty());
  clock.advance_to_us(10'000'001);
  const auto overdue = hub->overdue();
  ASSERT_EQ(overdue.size(), 1u);
  EXPECT_EQ(overdue[0].first, silent);
  EXPECT_EQ(overdue[0].second.id, ErrorId::kNetworkTimeout);
}

}  // namespace
}  // namespace mirage::test
