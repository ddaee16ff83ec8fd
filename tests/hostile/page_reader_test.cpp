// Browsers that ask for the page's largest part and do not read it.

#include <gtest/gtest.h>

#include <chrono>
#include <list>
#include <thread>

#include "tests/hostile/beside.h"
#include "tests/hostile/page_folder.h"
#include "tests/support/raw_peer.h"

namespace mirage::test {
namespace {

constexpr std::size_t kPartBytes = 4u << 20;
constexpr int kReaders = 100;

// A copy for each of them would be 400 MB.
TEST(PageReaders, WhoDoNotReadHoldNoCopyAndNobodyUp) {
  const Server server("builtin:knot?tubular=60&radial=12",
                      {"--no-view", "--web", page_folder(kPartBytes)});
  ASSERT_TRUE(server.ready()) << server.log();
  std::list<RawPeer> readers;
  const Cost cost = cost_of("100 who do not read the page", server, [&] {
    for (int i = 0; i < kReaders; ++i) {
      readers.emplace_back(server.port(), PeerFrom{"127.0.0.1", 4096}).say(kAskForPart);
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));
  });
  EXPECT_LT(cost.more_mb(), 16);
  expect_served(cost, 300);
  // A client that reads gets all of it.
  RawPeer reader(server.port());
  reader.say(kAskForPart);
  std::size_t heard = 0;
  for (std::string part; !(part = reader.hear_within(2000)).empty();) heard += part.size();
  EXPECT_GT(heard, kPartBytes);
}

}  // namespace
}  // namespace mirage::test
