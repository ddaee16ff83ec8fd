// Sessions without sockets: greeting, hostile bytes, clients that are too many, silent or do not
// read.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "tests/support/session_hub_test.h"

namespace mirage::test {
namespace {

class ServerSession : public SessionHubTest {};

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
  EXPECT_EQ(welcome->revision, hub->revision());
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
        type == wire::Body::OpenRequest || type == wire::Body::ViewRequest) {
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

TEST_F(ServerSession, EveryByteSentIsCounted) {
  const SessionId id = hub->open().take();
  ASSERT_TRUE(send(id, hello()).ok());
  std::size_t sent = 0;
  while (const FramePtr frame = hub->next_frame(id)) sent += frame->size();
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
