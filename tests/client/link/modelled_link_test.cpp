// Modelled link: arrival times follow the formula, in whatever order the real replies arrive.
#include "client/link/modelled_link.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

namespace mirage::test {
namespace {

constexpr std::size_t kPayload = 10'000;
constexpr double kReplyBytes = kPayload + 144 + 24;  // control part, our header, and WebSocket's
constexpr std::int64_t kStepUs = 100;

/// Answers every ask at once, in an order of its own.
class InstantServer final : public Link {
 public:
  explicit InstantServer(std::uint32_t scramble) : random_(scramble) {}
  void send(Bytes bytes) override {
    Result<Message> message = decode_message(bytes.data(), bytes.size());
    ASSERT_TRUE(message);
    if (mute) return;
    if (message->body.AsHello()) {
      Message welcome;
      welcome.body.Set(wire::WelcomeT{});
      ready_.push_back(std::move(welcome));
    }
    if (const wire::RequestBatchT* batch = message->body.AsRequestBatch()) {
      answer<wire::MeshReplyT>(batch->mesh_asks, kPayload);
      answer<wire::ImageReplyT>(batch->image_asks, kPayload / 2);
      answer<wire::TileReplyT>(batch->asks, kPayload);
    }
  }
  template <typename ReplyT, typename AskT>
  void answer(const std::vector<AskT>& asks, std::size_t payload) {
    for (const AskT& ask : asks) {
      ReplyT reply;
      reply.request_id = ask.request_id();
      Message message;
      message.body.Set(std::move(reply));
      message.payload.resize(payload);
      message.payload_bytes = payload;
      ready_.push_back(std::move(message));
    }
  }
  std::vector<Message> receive() override {
    std::shuffle(ready_.begin(), ready_.end(), random_);
    return std::exchange(ready_, {});
  }
  bool connected() const override { return up; }
  std::uint32_t generation() const override { return connections; }
  LinkTraffic traffic() const override { return {}; }

  bool mute = false;
  bool up = true;
  std::uint32_t connections = 1;

 private:
  std::mt19937 random_;
  std::vector<Message> ready_;
};

wire::RequestBatchT batch_of(std::uint32_t first, std::uint32_t count) {
  wire::RequestBatchT batch;
  for (std::uint32_t i = 0; i < count; ++i) {
    // Later asks are worse, so the server reverses the order.
    batch.asks.emplace_back(first + i, 0, 0, static_cast<float>(i + 1), 0, 0, std::uint16_t{0},
                            std::uint16_t{0}, std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0},
                            std::uint8_t{3}, std::uint16_t{0});
  }
  return batch;
}

using Arrivals = std::vector<std::pair<std::uint32_t, std::int64_t>>;  // request, time

struct Session {
  Session(const NetModel& model, std::uint32_t scramble, bool blocking = true)
      : server(scramble), link(server, clock, model, blocking, [this] {
          ++waits;
          return false;
        }) {}
  void run_until(std::int64_t end_us) {
    for (std::int64_t t = clock.now_us(); t <= end_us; t += kStepUs) {
      clock.advance_to_us(t);
      for (const Message& m : link.receive()) {
        if (const wire::TileReplyT* tile = m.body.AsTileReply()) {
          arrivals.emplace_back(tile->request_id, t);
        }
        if (const wire::MeshReplyT* mesh = m.body.AsMeshReply()) {
          arrivals.emplace_back(mesh->request_id, t);
        }
        if (const wire::ImageReplyT* image = m.body.AsImageReply()) {
          arrivals.emplace_back(image->request_id, t);
        }
      }
    }
  }
  VirtualClock clock;
  InstantServer server;
  ModelledLink link;
  Arrivals arrivals;
  int waits = 0;
};

TEST(CoreModelledLink, ArrivalTimes) {
  constexpr std::uint32_t kTiles = 12;
  for (const double rtt : {0.0, 20.0, 100.0}) {
    for (const double rate : {0.0, 5.0, 50.0}) {
      for (const double server_ms : {0.0, 5.0, 30.0}) {
        NetModel model;
        model.rtt_ms = rtt;
        model.rate_mbps = rate;
        model.server_ms = server_ms;
        Session session(model, 1);
        const Bytes request = encode_message(batch_of(1, kTiles));
        const auto request_bytes = static_cast<double>(request.size() + 12);
        const double up_ms = rate > 0 ? request_bytes * 8e-3 / rate : 0.0;
        const double down_ms = rate > 0 ? kReplyBytes * 8e-3 / rate : 0.0;
        session.link.send(request);
        session.run_until(900'000);
        ASSERT_EQ(session.arrivals.size(), kTiles);
        for (std::uint32_t n = 1; n <= kTiles; ++n) {
          EXPECT_EQ(session.arrivals[n - 1].first, kTiles + 1 - n) << "worst first";
          // The slower one of server and link sets the pace; the other one adds its time once.
          const double expected =
              up_ms + rtt + std::max(server_ms, down_ms) * n + std::min(server_ms, down_ms);
          EXPECT_NEAR(static_cast<double>(session.arrivals[n - 1].second) * 1e-3, expected, 1.0)
              << "tile " << n << " rtt " << rtt << " rate " << rate << " server " << server_ms;
        }
        const LinkTraffic traffic = session.link.traffic();
        EXPECT_EQ(traffic.bytes_up, request.size() + 12);
        EXPECT_EQ(static_cast<double>(traffic.bytes_down), kTiles * kReplyBytes);
      }
    }
  }
}

NetModel rough_model(std::uint64_t seed) {
  NetModel model;
  model.rtt_ms = 60;
  model.jitter_ms = 15;
  model.rate_mbps = 20;
  model.loss_percent = 10;
  model.server_ms = 3;
  model.seed = seed;
  return model;
}

Arrivals rough_run(std::uint64_t seed, std::uint32_t scramble) {
  Session session(rough_model(seed), scramble);
  for (std::uint32_t i = 0; i < 10; ++i) {
    session.link.send(encode_message(batch_of(1 + i * 10, 10)));
    session.run_until(session.clock.now_us() + 50'000);
  }
  session.run_until(session.clock.now_us() + 3'000'000);
  return session.arrivals;
}

TEST(CoreModelledLink, OrderOfTheRealRepliesMeansNothing) {
  const Arrivals first = rough_run(7, 1);
  EXPECT_EQ(first.size(), 100u);
  for (std::uint32_t scramble = 2; scramble < 8; ++scramble) {
    EXPECT_EQ(rough_run(7, scramble), first);
  }
}

TEST(CoreModelledLink, LossAndJitterComeFromTheSeed) {
  EXPECT_EQ(rough_run(7, 1), rough_run(7, 1));
  EXPECT_NE(rough_run(7, 1), rough_run(8, 1));
}

TEST(CoreModelledLink, LossAndJitterKeepTheOrder) {
  NetModel plain = rough_model(1);
  plain.jitter_ms = plain.loss_percent = 0;
  Session still(plain, 1);
  still.link.send(encode_message(batch_of(1, 50)));
  still.run_until(3'000'000);
  Session rough(rough_model(9), 1);
  rough.link.send(encode_message(batch_of(1, 50)));
  rough.run_until(3'000'000);
  ASSERT_EQ(still.arrivals.size(), 50u);
  ASSERT_EQ(rough.arrivals.size(), 50u);
  std::int64_t latest = 0;
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(rough.arrivals[i].first, still.arrivals[i].first);
    latest = std::max(latest, rough.arrivals[i].second - still.arrivals[i].second);
  }
  EXPECT_GE(latest, 70'000) << "a lost message must cost one and a half round trips";
}

TEST(CoreModelledLink, CancelBeforeServiceDropsTheReply) {
  NetModel model;
  model.rtt_ms = 20;
  model.server_ms = 50;
  Session session(model, 1);
  session.link.send(encode_message(batch_of(1, 3)));  // served 3, 2, 1 from 10, 60, 110 ms
  session.run_until(10'000);
  wire::RequestBatchT cancel;
  cancel.cancels = {1, 3, 99};  // the service of 3 has begun when this arrives
  session.link.send(encode_message(std::move(cancel)));
  session.run_until(1'000'000);
  ASSERT_EQ(session.arrivals.size(), 2u);
  EXPECT_EQ(session.arrivals[0].first, 3u);
  EXPECT_EQ(session.arrivals[1].first, 2u);
}

TEST(CoreModelledLink, SaysHowLongAMessageHasWaited) {
  NetModel model;
  model.rtt_ms = 20;
  model.server_ms = 50;
  Session session(model, 1);
  session.link.send(encode_message(batch_of(1, 2)));
  session.clock.advance_to_us(1'000'000);
  const std::vector<Message> messages = session.link.receive();
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_NEAR(static_cast<double>(messages[0].waited_us), 930'000, 100);
  EXPECT_NEAR(static_cast<double>(messages[1].waited_us), 880'000, 100);
}

TEST(CoreModelledLink, CancelCountsHoweverSeldomOneLooks) {
  NetModel model;
  model.rtt_ms = 20;
  model.server_ms = 50;
  Session session(model, 1);
  session.link.send(encode_message(batch_of(1, 3)));
  session.clock.advance_to_us(10'000);
  wire::RequestBatchT cancel;
  cancel.cancels = {1};
  session.link.send(encode_message(std::move(cancel)));
  session.clock.advance_to_us(1'000'000);
  EXPECT_EQ(session.link.receive().size(), 2u);
}

TEST(CoreModelledLink, GeometryArrivesWhateverOrderItReallyCameIn) {
  NetModel model;
  model.rtt_ms = 50;
  model.rate_mbps = 10;
  model.server_ms = 5;
  std::set<Arrivals> different;
  for (std::uint32_t scramble = 0; scramble < 8; ++scramble) {
    Session session(model, scramble);
    wire::RequestBatchT batch = batch_of(1, 4);
    for (std::uint32_t i = 0; i < 4; ++i) {
      batch.mesh_asks.emplace_back(20 + i, i, std::uint8_t{0});
      batch.image_asks.emplace_back(30 + i, i, std::uint8_t{0});
    }
    session.link.send(encode_message(std::move(batch)));
    session.run_until(400'000);
    ASSERT_EQ(session.arrivals.size(), 12u);
    different.insert(session.arrivals);
  }
  EXPECT_EQ(different.size(), 1u);
  // The first geometry takes half a round trip up, its preparation, its bytes, and half a trip
  // down.
  const Arrivals& one = *different.begin();
  const auto first =
      std::find_if(one.begin(), one.end(), [](const auto& a) { return a.first == 20; });
  EXPECT_NEAR(static_cast<double>(first->second) * 1e-3, 50 + 5 + 8, 9.5);
}

TEST(CoreModelledLink, NothingBetweenIsAtOnce) {
  NetModel model;
  model.server_ms = 0;
  Session session(model, 1);
  session.link.send(encode_message(batch_of(1, 3)));
  EXPECT_EQ(session.link.receive().size(), 3u);
}

// Twelve tiles of 10 kB: 4 ms each on the link at 20 Mbit/s, 10 ms each at the server.
TEST(CoreModelledLink, SaysHowBusyBothEndsWere) {
  NetModel model;
  model.rtt_ms = 20;
  model.rate_mbps = 20;
  model.server_ms = 10;
  Session session(model, 3);
  session.link.send(encode_message(batch_of(1, 12)));
  session.run_until(500'000);
  const LinkUse use = session.link.use();
  EXPECT_NEAR(use.server, 0.12 / 0.5, 0.001);
  EXPECT_NEAR(use.link, 12 * kReplyBytes * 8 / 20e6 / 0.5, 0.001);
  EXPECT_TRUE(starves(true, use));
  EXPECT_FALSE(starves(false, use));
  EXPECT_FALSE(starves(true, {0.85, 0}));
  EXPECT_FALSE(starves(true, {0, 0.95}));
}

// One trip is for TCP, one for the upgrade. The hello waits for both, on every connection.
TEST(CoreModelledLink, ConnectingTakesTwoRoundTrips) {
  NetModel model;
  model.rtt_ms = 40;
  Session session(model, 1);
  for (int connection = 0; connection < 2; ++connection) {
    session.link.receive();
    const std::int64_t began = session.clock.now_us();
    EXPECT_FALSE(session.link.connected());
    session.run_until(began + 79'900);
    EXPECT_FALSE(session.link.connected());
    session.run_until(began + 80'000);
    EXPECT_TRUE(session.link.connected());
    ++session.server.connections;
  }
}

TEST(CoreModelledLink, AWelcomeTellsTheModelsSpeed) {
  for (const double server_ms : {0.0, 20.0}) {
    NetModel model;
    model.server_ms = server_ms;
    Session session(model, 1);
    session.link.send(encode_message(wire::HelloT{}));
    const std::vector<Message> messages = session.link.receive();
    ASSERT_EQ(messages.size(), 1u);
    EXPECT_EQ(messages[0].body.AsWelcome()->tile_us, 1000 * server_ms);
  }
}

TEST(CoreModelledLink, OutageDoesNotHang) {
  NetModel model;
  Session session(model, 1);
  session.server.mute = true;
  session.link.send(encode_message(batch_of(1, 3)));
  EXPECT_TRUE(session.link.receive().empty());
  EXPECT_EQ(session.waits, 1) << "no hope: asked once, then on";
  session.server.up = false;
  EXPECT_TRUE(session.link.receive().empty());
  EXPECT_EQ(session.waits, 1) << "nothing to wait for while the connection is down";
  EXPECT_FALSE(session.link.connected());
  session.server.up = true;
  ++session.server.connections;
  EXPECT_TRUE(session.link.receive().empty());
  EXPECT_EQ(session.waits, 1) << "a new connection that has not been greeted owes nothing";
}

TEST(CoreModelledLink, NewConnectionOwesNothingOfTheOld) {
  NetModel model;
  Session session(model, 1);
  session.server.mute = true;
  wire::RequestBatchT batch = batch_of(1, 3);
  batch.mesh_asks = {wire::MeshAsk(77, 7, 0)};
  session.link.send(encode_message(std::move(batch)));
  wire::ReferenceRequestT reference;
  reference.eye = std::make_unique<wire::Vec3d>();
  reference.rotation = std::make_unique<wire::Quat>(1.0f, 0.0f, 0.0f, 0.0f);
  reference.fov_y = 1;
  reference.width = reference.height = reference.supersample = 1;
  session.link.send(encode_message(std::move(reference)));
  session.server.mute = false;
  session.link.send(encode_message(wire::HelloT{}));
  session.link.receive();
  EXPECT_EQ(session.waits, 0);
}

TEST(CoreModelledLink, RealTimeDoesNotWait) {
  NetModel model;
  model.rtt_ms = 10;
  Session session(model, 1, false);
  session.server.mute = true;
  session.link.send(encode_message(batch_of(1, 3)));
  EXPECT_TRUE(session.link.receive().empty());
  EXPECT_EQ(session.waits, 0);
}

TEST(CoreModelledLink, ParsesModels) {
  const auto model = parse_net_model("rtt=100,jitter=20.5,rate=20,loss=0.5,server-ms=5,seed=42");
  ASSERT_TRUE(model) << model.error().text;
  EXPECT_EQ(model->rtt_ms, 100);
  EXPECT_EQ(model->jitter_ms, 20.5);
  EXPECT_EQ(model->rate_mbps, 20);
  EXPECT_EQ(model->loss_percent, 0.5);
  EXPECT_EQ(model->server_ms, 5);
  EXPECT_EQ(model->seed, 42u);
  EXPECT_LT(parse_net_model("rtt=1,server-ms=auto")->server_ms, 0);
  EXPECT_EQ(parse_net_model("")->rtt_ms, 0);
  for (const char* bad :
       {"rtt=nan", "rtt=-1", "rtt=inf", "rtt=", "rtt", "rtt=1x", "speed=3", "loss=91", "rtt=1e9",
        "server-ms=-1", "seed=-1", "rtt=1,,rate=2", "=3", "rtt=auto", "jitter=-nan"}) {
    const auto refused = parse_net_model(bad);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().id, ErrorId::kUsage);
  }
  EXPECT_NE(parse_net_model("rtt=1,rate=no").error().text.find("rate=no"), std::string::npos);
}

}  // namespace
}  // namespace mirage::test
