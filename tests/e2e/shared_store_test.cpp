// Servers that share their tiles through Redis: tiles are found, left to another server, or missed.
#include "server/source/shared_store.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "protocol/base/clock.h"
#include "tests/support/metrics.h"
#include "tests/support/process.h"

namespace mirage::test {
namespace {

const char* const kRedis = "/usr/bin/redis-server";

int free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(at);
  bind(socket, reinterpret_cast<sockaddr*>(&at), size);
  getsockname(socket, reinterpret_cast<sockaddr*>(&at), &size);
  close(socket);
  return ntohs(at.sin_port);
}

/// A Redis server for this test alone.
class Redis {
 public:
  Redis() : port_(free_port()), folder_(scratch_folder()) { start(); }
  ~Redis() { send(SIGKILL); }
  void start() {
    run({kRedis, "--port", std::to_string(port_), "--bind", "127.0.0.1", "--save", "",
         "--daemonize", "yes", "--pidfile", folder_ + "/pid", "--dir", folder_});
    for (int i = 0; i < 500 && ask({"ping"}) != "PONG\n"; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    pid_ = std::atoi(read_file(folder_ + "/pid").c_str());
  }
  void send(int signal) const {
    if (pid_ > 0) kill(pid_, signal);
  }
  std::string ask(std::vector<std::string> command) const {
    command.insert(command.begin(), {"/usr/bin/redis-cli", "-p", std::to_string(port_)});
    return run(command).output;
  }
  std::string url() const { return "redis://127.0.0.1:" + std::to_string(port_); }
  StoreAddress address() const { return parse_store_url(url()).take(); }

 private:
  int port_, pid_ = 0;
  std::string folder_;
};

class SharedStore : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kRedis)) GTEST_SKIP() << "redis-server is not installed";
    redis_ = std::make_unique<Redis>();
  }
  std::unique_ptr<TileSource> source() {
    Result<std::unique_ptr<TileSource>> store = open_shared_store(redis_->address(), clock_);
    EXPECT_TRUE(store) << store.error().line();
    return store.take();
  }
  static double ms_of(const std::function<void()>& what) {
    const SteadyClock clock;
    what();
    return static_cast<double>(clock.now_us()) / 1000;
  }
  static nlohmann::json load(const Server& server, const std::vector<std::string>& extra = {}) {
    const std::string file = scratch_folder() + "/load.json";
    std::vector<std::string> command = {
        binary("mirage-load"), server.url(), "--clients", "4", "--json", file, "--verify", "1"};
    command.insert(command.end(), extra.begin(), extra.end());
    if (extra.empty()) command.insert(command.end(), {"--duration", "2"});
    const Finished done = run(command);
    EXPECT_EQ(done.exit_code, 0) << done.output;
    return nlohmann::json::parse(read_file(file));
  }
  Server server(const std::string& scene = "builtin:clutter?objects=40") {
    return Server(scene, {"--store", redis_->url(), "--metrics"});
  }

  SteadyClock clock_;
  std::unique_ptr<Redis> redis_;
};

/// Returns a counter of the server.
double metric(const Server& server, const std::string& name) { return metrics(server)[name]; }

const FormId kOne{{1, 2}, TileCodec::kZstd}, kLossy{{1, 2}, TileCodec::kWebp};

TEST(StoreUrl, SaysWhereAndWhatIsWrong) {
  const StoreAddress whole = parse_store_url("redis://:pass@word@host:7000/3").take();
  EXPECT_EQ(whole.host, "host");
  EXPECT_EQ(whole.password, "pass@word");
  EXPECT_EQ(whole.port, 7000);
  EXPECT_EQ(whole.database, 3);
  EXPECT_EQ(parse_store_url("redis://host").take().port, 6379);
  EXPECT_EQ(parse_store_url("redis://[::1]:7000").take().host, "::1");
  for (const char* wrong : {"", "host:1", "http://host", "redis://", "redis://:1", "redis://h:0",
                            "redis://h:x", "redis://h/x", "redis://user:p@h", "redis://@h"}) {
    EXPECT_FALSE(parse_store_url(wrong)) << wrong;
  }
  const Finished done = run({binary("mirage-server"), "builtin:knot", "--store", "nowhere"});
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_NE(done.output.find("redis://[:PASSWORD@]HOST"), std::string::npos) << done.output;
}

TEST_F(SharedStore, WhatOneOffersTheOtherHas) {
  const auto a = source(), b = source();
  EXPECT_FALSE(b->fetch(kOne));
  Bytes bytes(70'000, 0);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 7);
  a->offer(kOne, bytes);
  EXPECT_EQ(b->fetch(kOne), bytes);
  EXPECT_FALSE(b->fetch(kLossy)) << "a record of its own";
}

TEST_F(SharedStore, OneRendersAndTheOthersWaitUntilItsLeaseEnds) {
  const auto a = source(), b = source();
  EXPECT_TRUE(a->claim(kOne.id));
  EXPECT_TRUE(a->claim(kOne.id)) << "its own lease holds nobody up";
  EXPECT_FALSE(b->claim(kOne.id));
  EXPECT_TRUE(b->claim({3, 4}));
  const double waited = ms_of([&] {
    while (!b->claim(kOne.id)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  });
  EXPECT_LT(waited, 2'300);
  // Leases last as long as tiles have taken, and these took next to nothing.
  for (std::uint64_t n = 100; n < 120; ++n) {
    ASSERT_TRUE(a->claim({n, n}));
    a->offer({{n, n}, TileCodec::kZstd}, {1});
  }
  ASSERT_TRUE(a->claim({5, 6}));
  EXPECT_LT(ms_of([&] {
              while (!b->claim({5, 6})) std::this_thread::sleep_for(std::chrono::milliseconds(5));
            }),
            200);
}

TEST_F(SharedStore, AWriteOutlastsAStoreThatIsSlowForASecond) {
  const auto a = source(), b = source();
  redis_->send(SIGSTOP);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(a->fetch(kOne));
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(900));
    redis_->send(SIGCONT);
  });
  EXPECT_TRUE(a->offer(kOne, {1, 2, 3}));
  later.join();
  EXPECT_EQ(b->fetch(kOne), (Bytes{1, 2, 3}));
}

TEST_F(SharedStore, OneThatDoesNotAnswerIsLeftAlone) {
  const auto a = source();
  a->offer(kOne, {1, 2, 3});
  redis_->send(SIGSTOP);
  EXPECT_LT(ms_of([&] { EXPECT_FALSE(a->fetch(kOne)); }), 60) << "a limit of 10 ms";
  EXPECT_LT(ms_of([&] {
              for (int i = 0; i < 100; ++i) EXPECT_FALSE(a->fetch(kOne));
              EXPECT_TRUE(a->claim({8, 9})) << "rendered here";
            }),
            60);
  redis_->send(SIGCONT);
  const double back = ms_of([&] {
    while (!a->fetch(kOne)) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  });
  EXPECT_LT(back, 1'500);
}

// A machine that is busy for longer than the limit of a read makes a server render. So this holds
// for one of three servers; each that renders renders less than the first.
TEST_F(SharedStore, AServerRendersNothingThatAnotherHas) {
  Server first = server();
  const nlohmann::json cold = load(first);
  EXPECT_EQ(cold["verify_failures"], 0);
  const double tiles = metric(first, "tiles_rendered_total");
  EXPECT_GT(tiles, 10);
  double rendered = tiles;
  for (int i = 0; i < 3 && rendered > 0; ++i) {
    Server other = server();
    const nlohmann::json warm = load(other);
    EXPECT_EQ(warm["verify_failures"], 0);
    EXPECT_EQ(warm["tiles"], cold["tiles"]);
    rendered = metric(other, "tiles_rendered_total");
    EXPECT_LT(rendered, tiles);
    EXPECT_EQ(rendered + metric(other, "tile_hits_total{tier=\"redis\"}"), tiles);
  }
  EXPECT_EQ(rendered, 0);
}

TEST_F(SharedStore, AServerWithOtherPixelsTakesNoneOfThem) {
  Server first = server();
  Server other("builtin:clutter?objects=40",
               {"--store", redis_->url(), "--metrics", "--supersample", "1"});
  load(first);
  load(other);
  EXPECT_EQ(metric(other, "tile_hits_total{tier=\"redis\"}"), 0);
  EXPECT_GT(metric(other, "tiles_rendered_total"), 10);
}

TEST_F(SharedStore, WrongRecordsAreMadeAnew) {
  Server first = server();
  load(first);
  const std::string spoil =
      "local n = 0 local last "
      "for _, k in ipairs(redis.call('keys', 'mirage:tile:*')) do "
      "  local v = redis.call('get', k) n = n + 1 "
      "  if n % 4 == 0 then redis.call('set', k, 'nonsense') "
      "  elseif n % 4 == 1 then redis.call('set', k, string.sub(v, 1, #v - 1)) "
      "  elseif n % 4 == 2 then redis.call('set', k, string.sub(v, 1, #v - 9) .. 'nonsense!') "
      "  elseif last then redis.call('set', k, last) end "
      "  last = v end return n";
  EXPECT_GT(std::atoi(redis_->ask({"eval", spoil, "0"}).c_str()), 10);
  Server second = server();
  const nlohmann::json told = load(second);
  EXPECT_EQ(told["verify_failures"], 0);
  EXPECT_GT(metric(second, "records_wrong_total"), 10);
  EXPECT_GT(metric(second, "tiles_rendered_total"), 10);
  Server third = server();
  load(third);
  EXPECT_EQ(metric(third, "records_wrong_total"), 0);
  EXPECT_EQ(metric(third, "tiles_rendered_total"), 0);
}

TEST_F(SharedStore, OneThatGoesAndComesBackCostsNoClientAnything) {
  Server one = server("builtin:knot");
  std::thread trouble([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    redis_->send(SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    redis_->start();
  });
  const nlohmann::json told = load(one, {"--duration", "6", "--rate", "10"});
  trouble.join();
  EXPECT_EQ(told["connected"], 4);
  EXPECT_EQ(told["verify_failures"], 0);
  for (const auto& [id, n] : told["errors"].items()) EXPECT_EQ(n, 0) << id;
  EXPECT_NE(one.log().find("does not answer"), std::string::npos);
}

}  // namespace
}  // namespace mirage::test
