// Sessions without sockets: greeting, hostile bytes, and clients that are too many, silent or do
// not read.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "server/session/hub_state.h"
#include "tests/support/session_hub_test.h"

namespace mirage::test {
namespace {

class ServerSession : public SessionHubTest {};

TEST_F(ServerSession, HelloIsAnsweredWithTheScene) {
  const SessionId id = hub->open();
  EXPECT_FALSE(hub->next_packet(id)) << "nothing before the hello";
  ASSERT_TRUE(send(id, hello()).ok());
  EXPECT_EQ(hub->take_writable(), std::set<SessionId>{id});
  const std::vector<Message> messages = drain(id);
  ASSERT_EQ(messages.size(), 3u);
  const wire::WelcomeT* welcome = messages[0].body.AsWelcome();
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->version, limits::kProtocolVersion);
  EXPECT_EQ(welcome->revision, hub->revision());
  EXPECT_EQ(welcome->objects, 1u);
  EXPECT_EQ(welcome->instances, 1u);
  ASSERT_TRUE(messages[1].body.AsObjectPage());
  EXPECT_EQ(messages[1].body.AsObjectPage()->objects[0]->radius, scene_->objects[0].radius);
  ASSERT_TRUE(messages[2].body.AsInstancePage());
  EXPECT_EQ(messages[2].body.AsInstancePage()->instances.size(), 1u);
}

TEST_F(ServerSession, MembersComeAfterTheDescriptionAndBeforeTiles) {
  const SessionId id = hub->open();
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
    const SessionId id = hub->open();
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
        type == wire::Body::OpenRequest || type == wire::Body::ViewRequest ||
        type == wire::Body::GroundRequest) {
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
  options.access = Access::parse("secret").take();
  restart(options);
  const auto error_of = [&](const std::function<void(wire::HelloT&)>& change) {
    wire::HelloT m = hello();
    m.token = "secret";
    change(m);
    const Result<void> result = send(hub->open(), std::move(m));
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

TEST_F(ServerSession, PlacesAreTakenByARightHello) {
  SessionOptions options;
  options.max_clients = 2;
  options.access = Access::parse("right").take();
  restart(options);
  wire::HelloT wrong = hello(), right = hello();
  wrong.token = "wrong";
  right.token = "right";
  for (int i = 0; i < 10; ++i) hub->open();  // silent clients take no place
  EXPECT_FALSE(send(hub->open(), wire::HelloT(wrong)));
  const SessionId first = hub->open();
  ASSERT_TRUE(send(first, wire::HelloT(right)));
  ASSERT_TRUE(send(hub->open(), wire::HelloT(right)));
  EXPECT_EQ(hub->state().clients, 2u);
  const Result<void> third = send(hub->open(), wire::HelloT(right));
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().id, ErrorId::kBusy);
  hub->close(first);
  EXPECT_TRUE(send(hub->open(), wire::HelloT(right)));
}

TEST_F(ServerSession, AnotherChoiceWaitsForItsOwnHub) {
  auto scene = std::make_shared<PreparedScene>(*scene_);
  scene->scene.choices = {{"walk", "run"}, {"red"}, {"walk", ""}};
  SessionOptions options;
  options.choices = true;
  options.max_clients = 2;
  restart(options, scene);
  const auto greet = [&](const std::string& clip, const std::string& variant) {
    const SessionId id = hub->open();
    wire::HelloT choosing = hello();
    choosing.clip = clip;
    choosing.variant = variant;
    EXPECT_TRUE(send(id, std::move(choosing)).ok());
    return id;
  };
  // Empty, shown or unknown: this hub's own.
  for (const char* clip : {"", "walk", "sleep"}) {
    const SessionId id = greet(clip, "");
    EXPECT_FALSE(hub->wants_elsewhere(id)) << clip;
    const wire::WelcomeT welcome = *drain(id).at(0).body.AsWelcome();
    EXPECT_EQ(welcome.clips, scene->scene.choices.clips);
    EXPECT_EQ(welcome.clip, "walk");
    hub->close(id);
  }
  const SessionId elsewhere = greet("run", "red");
  ASSERT_TRUE(hub->wants_elsewhere(elsewhere));
  EXPECT_EQ(*hub->wants_elsewhere(elsewhere), (SceneChoice{"run", "red"}));
  EXPECT_EQ(*hub->wants_elsewhere(greet("", "red")), (SceneChoice{"walk", "red"}));
  EXPECT_TRUE(drain(elsewhere).empty());
  EXPECT_FALSE(hub->greeted(elsewhere));
  clock.advance_to_us(60'000'000);
  EXPECT_TRUE(hub->overdue().empty()) << "loading may take long";
  EXPECT_FALSE(send(elsewhere, sample_open_request()).ok());
  // A client that went elsewhere takes a place here.
  greeted();
  hub->set_clients_elsewhere(1);
  EXPECT_EQ(send(hub->open(), hello()).error().id, ErrorId::kBusy);
  // A hub without choices shows everybody the same, and offers nothing.
  restart({}, scene);
  const SessionId same = greet("run", "");
  EXPECT_FALSE(hub->wants_elsewhere(same));
  EXPECT_TRUE(drain(same).at(0).body.AsWelcome()->clips.empty());
}

TEST_F(ServerSession, BeforeTheHelloThereIsNothingButAHello) {
  const Bytes much(4097, 0);
  EXPECT_EQ(hub->receive(hub->open(), much.data(), much.size()).error().id, ErrorId::kWireLimit);
  // The first of two chunks.
  wire::HelloT large = hello();
  large.name = std::string(4000, 'x');
  Bytes chunk(kWireHeaderBytes + kChunkPrefixBytes + 100);
  PacketHeader header;
  header.kind = PacketKind::kChunk;
  header.payload_bytes = kChunkPrefixBytes + 100;
  write_packet_header(header, chunk.data());
  chunk[kWireHeaderBytes] = 1;
  chunk[kWireHeaderBytes + 5] = 1;  // of 256 bytes
  const Result<void> told = hub->receive(hub->open(), chunk.data(), chunk.size());
  ASSERT_FALSE(told);
  EXPECT_EQ(told.error().id, ErrorId::kWireState);
}

TEST_F(ServerSession, OfManyStrangersTheFirstGo) {
  const SessionId client = greeted();
  const SessionId first = hub->open();
  for (int i = 0; i < 255; ++i) hub->open();
  EXPECT_TRUE(hub->overdue().empty());
  hub->open();
  const auto overdue = hub->overdue();
  ASSERT_EQ(overdue.size(), 1u);
  EXPECT_EQ(overdue[0].first, first);
  EXPECT_NE(first, client);
}

TEST_F(ServerSession, EveryByteSentIsCounted) {
  const SessionId id = hub->open();
  ASSERT_TRUE(send(id, hello()).ok());
  std::size_t sent = 0;
  while (const PacketPtr packet = hub->next_packet(id)) sent += packet->size();
  EXPECT_GT(sent, 0u);
  EXPECT_EQ(counters.bytes_sent, sent);
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

TEST_F(ServerSession, HostileBytesHurtOnlyTheirSender) {
  const SessionId good = greeted();
  ASSERT_TRUE(send_ask(good, ask(1)).ok());
  std::mt19937 random(13);
  const std::vector<Bytes> samples = sample_messages();
  int errors = 0;
  for (int i = 0; i < 5000; ++i) {
    const SessionId bad = hub->open();
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
  EXPECT_EQ(hub->state().clients, 1u);
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

// A batch may ask for far more than a client may leave unread, so meshes are made as they are sent.
TEST_F(ServerSession, AsksForAMeshCostNoMemoryUntilTheirTurn) {
  const SessionId id = greeted();
  drain(id);
  wire::RequestBatchT batch;
  for (std::uint32_t i = 0; i < limits::kMaxAsksPerBatch; ++i) {
    batch.mesh_asks.emplace_back(i + 1, 0, 0);
  }
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  EXPECT_EQ(counters.meshes_sent, 0u);
  ASSERT_TRUE(hub->next_packet(id));
  EXPECT_EQ(counters.meshes_sent, 1u);
  EXPECT_TRUE(hub->overdue().empty());
  EXPECT_EQ(drain(id).size(), limits::kMaxAsksPerBatch - 1);
}

TEST_F(ServerSession, WhoHasMuchUnreadIsRefusedMore) {
  SessionOptions options;
  options.max_outbox_bytes = 5000;
  restart(options);
  const SessionId id = greeted(), other = greeted();
  drain(id);
  for (std::uint32_t i = 1; i <= 5; ++i) {
    wire::Ask a = ask(i);
    ASSERT_TRUE(send_ask(id, a).ok());
  }
  render_all(3000);
  ASSERT_TRUE(send_ask(other, ask(1)).ok());
  EXPECT_EQ(drain(other).size(), 1u) << "from the store, while the first reads nothing";
  std::size_t tiles = 0, refused = 0;
  for (const Message& message : drain(id)) {
    tiles += message.body.AsTileReply() != nullptr;
    refused += message.body.AsRefused() != nullptr;
  }
  EXPECT_EQ(tiles, 2u);
  EXPECT_EQ(refused, 3u);
}

TEST_F(ServerSession, WhoTakesNothingForLongIsOverdue) {
  const SessionId id = greeted(), idle = greeted();
  drain(id);
  drain(idle);
  ASSERT_TRUE(send_ask(id, ask(1)).ok());
  render_all();
  clock.advance_to_us(29'000'000);
  EXPECT_TRUE(hub->overdue().empty());
  clock.advance_to_us(31'000'000);
  const auto overdue = hub->overdue();
  ASSERT_EQ(overdue.size(), 1u) << "who has nothing to read is not";
  EXPECT_EQ(overdue[0].first, id);
  drain(id);
  EXPECT_TRUE(hub->overdue().empty());
}

// A mesh is made when its turn comes; until then it waits in no outbox.
TEST_F(ServerSession, WhoTakesNoneOfTheMeshesItAskedForIsOverdue) {
  const SessionId id = greeted();
  clock.advance_to_us(60'000'000);  // nothing to read: it may take as long as it likes
  wire::RequestBatchT batch;
  batch.mesh_asks = {wire::MeshAsk(1, 0, 0), wire::MeshAsk(2, 0, 0)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  EXPECT_TRUE(hub->overdue().empty());
  ASSERT_TRUE(hub->next_packet(id));
  clock.advance_to_us(89'000'000);
  EXPECT_TRUE(hub->overdue().empty());
  clock.advance_to_us(91'000'000);
  EXPECT_EQ(hub->overdue().size(), 1u);
}

TEST_F(ServerSession, WhoGivesCreditAfterLongIsNotOverdueForIt) {
  const SessionId id = greeted();
  wire::RequestBatchT batch;
  batch.asks = {ask(1)};
  ASSERT_TRUE(send(id, std::move(batch)).ok());
  render_all();
  clock.advance_to_us(60'000'000);
  EXPECT_TRUE(hub->overdue().empty()) << "it may not be sent";
  wire::RequestBatchT credit;
  credit.credit_bytes = 1 << 20;
  ASSERT_TRUE(send(id, std::move(credit)).ok());
  EXPECT_TRUE(hub->overdue().empty());
  clock.advance_to_us(91'000'000);
  EXPECT_EQ(hub->overdue().size(), 1u);
}

TEST_F(ServerSession, WhileDrainingWhatWasAskedForIsServedAndNothingElse) {
  const SessionId id = greeted();
  drain(id);
  ASSERT_TRUE(send_ask(id, ask(1)).ok());
  hub->drain();
  EXPECT_FALSE(hub->drained());
  ASSERT_TRUE(send_ask(id, ask(2, 1)).ok());
  EXPECT_FALSE(send(hub->open(), hello()));
  EXPECT_EQ(render_all(), 1u);
  EXPECT_FALSE(hub->drained());
  const std::vector<Message> messages = drain(id);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_TRUE(messages[0].body.AsRefused() && messages[1].body.AsTileReply());
  EXPECT_TRUE(hub->drained());
}

// An ask that would be late is refused at once, not when it is late.
TEST_F(ServerSession, WhatWouldBeLateIsRefusedAtOnce) {
  const SessionId id = greeted();
  drain(id);
  ASSERT_TRUE(send_ask(id, ask(1)).ok());
  for (const TileJob& job : take_tiles()) {  // each took a second
    auto tile = std::make_shared<StoredTile>();
    tile->reply = sample_tile_reply();
    tile->reply.render_us = 1'000'000;
    tile->planes.resize(100);
    hub->complete(FinishedTile{job.id, TileCodec::kZstd, tile, tile});
  }
  drain(id);
  const auto refused = [&](std::uint32_t request, std::uint32_t deadline_ms) {
    const auto x = static_cast<std::uint16_t>(request);
    const wire::Ask one(request, 0, 0, 1.0f, deadline_ms, 8, x, 0, 9, 2, 2, kLitTile, 0);
    EXPECT_TRUE(send_ask(id, one).ok());
    const std::vector<Message> messages = drain(id);
    return messages.size() == 1 && messages[0].body.AsRefused();
  };
  EXPECT_FALSE(refused(2, 1500)) << "nothing is before it";
  EXPECT_TRUE(refused(3, 500)) << "one is, and takes a second";
  EXPECT_FALSE(refused(4, 0)) << "it may come whenever";
}

TEST_F(ServerSession, SilentClientsAreOverdue) {
  const SessionId silent = hub->open();
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
