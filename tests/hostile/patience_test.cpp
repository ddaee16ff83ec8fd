// Patience: inactive peers are closed: after ten seconds without a handshake or a hello, thirty
// without reading, twenty for a browser that does not read the page. All are waited for at once, on
// servers where nothing else happens.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <thread>

#include "tests/hostile/beside.h"
#include "tests/hostile/client.h"
#include "tests/hostile/page_folder.h"

namespace mirage::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLongestS = 40;

struct Waited {
  double hello_s = 1e9, reading_s = 1e9;
  bool half_closed = false, odd_closed = false, dripping_stays = false, contented_stays = false;
  bool browser_closed = false;
};

Waited wait_for_all() {
  Waited out;
  const Server quiet("builtin:knot?tubular=60&radial=12",
                     {"--no-view", "--web", page_folder(8u << 20)});
  const Server busy("builtin:knot?tubular=400&radial=64", {"--no-view"});
  Client deaf(busy.port(), "", PeerFrom{"127.0.0.1", 4096});
  Client dripping(busy.port(), "", PeerFrom{"127.0.0.1", 4096});
  Client contented(busy.port());
  const Clock::time_point start = Clock::now();
  const WebSocket silent(quiet.port());
  // Half a handshake, and one whose headers have no end for the library.
  RawPeer half(quiet.port()), odd(quiet.port());
  half.say("GET / HTTP/1.1\r\nHost: x\r\n");
  odd.say("GET / HTTP/1.1\r\nHost: x\r\nnonsense\r\n\r\n");
  RawPeer browser(quiet.port(), PeerFrom{"127.0.0.1", 4096});
  browser.say(kAskForPart);
  for (Client* client : {&deaf, &dripping}) {
    wire::RequestBatchT batch;
    for (std::uint32_t i = 1; i <= 1000; ++i) batch.mesh_asks.emplace_back(i, 0u, 0);
    client->send(std::move(batch));
  }
  while (seconds_since(start) < kLongestS && out.reading_s > kLongestS) {
    const double now_s = seconds_since(start);
    if (quiet.log().find("no hello within") != std::string::npos) {
      out.hello_s = std::min(out.hello_s, now_s);
    }
    if (busy.log().find("does not read") != std::string::npos) out.reading_s = now_s;
    dripping.socket().peer().hear_within(0);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  out.half_closed = half.closed();
  out.odd_closed = odd.closed();
  out.browser_closed = browser.closed();
  out.dripping_stays = !dripping.socket().ended();
  out.contented_stays = contented.tile_ms(kSmall) >= 0;
  return out;
}

// The waiting starts together with the other tests, and runs beside them.
class Waiting : public ::testing::Environment {
 public:
  void SetUp() override { waited_ = std::async(std::launch::async, wait_for_all); }
  void TearDown() override {
    if (waited_.valid()) waited_.wait();
  }
  Waited take() { return waited_.get(); }

 private:
  std::future<Waited> waited_;
};

auto* const waiting =
    static_cast<Waiting*>(::testing::AddGlobalTestEnvironment(new Waiting));  // gtest owns it

// Rows 4 and 11: the server used to wait for a hello as long as nothing else woke it, and a client
// that took nothing kept its answers for ever.
TEST(Patience, EndsForThoseWhoSayNothingAndThoseWhoReadNothing) {
  const Waited waited = waiting->take();
  std::printf("11: closed without a hello after %.1f s; 4: without reading after %.1f s\n",
              waited.hello_s, waited.reading_s);
  EXPECT_NEAR(waited.hello_s, 10.5, 1);
  EXPECT_NEAR(waited.reading_s, 31, 2);
  EXPECT_TRUE(waited.half_closed && waited.odd_closed) << "after ten seconds";
  EXPECT_TRUE(waited.browser_closed) << "after twenty seconds";
  EXPECT_TRUE(waited.contented_stays) << "he has nothing to read";
  EXPECT_TRUE(waited.dripping_stays) << "he reads";
}

}  // namespace
}  // namespace mirage::test
