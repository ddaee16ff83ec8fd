// A server whose memory is capped a little above what it uses: it refuses what has no room, and
// goes on.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <map>
#include <thread>

#include "tests/hostile/beside.h"
#include "tests/hostile/client.h"

namespace mirage::test {
namespace {

constexpr std::size_t kMegabyte = 1u << 20;

std::size_t address_space(int pid) {
  std::size_t pages = 0;
  std::ifstream("/proc/" + std::to_string(pid) + "/statm") >> pages;
  return pages * 4096;
}

/// Returns the answers to requests that need much memory, by their kind.
std::map<std::string, int> answers_to_much(int port) {
  std::map<std::string, int> out;
  Client greedy(port);
  std::uint32_t request = 0;
  for (int round = 0; round < 2; ++round) {
    std::vector<wire::Ask> asks;
    for (int i = 0; i < 4; ++i) asks.push_back(new_tile(++request, kLargest));
    greedy.ask(std::move(asks));
    greedy.send(full_render(++request, 4096, 4096));
    for (int i = 0; i < 5; ++i) {
      const std::optional<Message> message = greedy.next(20'000);
      if (!message) return out;
      const wire::RefusedT* no = message->body.AsRefused();
      ++out[!no ? "given" : no->reason == wire::RefusalReason::TooLarge ? "too large" : "refused"];
    }
  }
  return out;
}

TEST(MemoryCap, WhatThereIsNoRoomForIsRefusedAndTheRestServed) {
  Server server("builtin:knot?tubular=60&radial=12", {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  for (const std::size_t more_mb : {100, 300, 600}) {
    const rlimit cap{address_space(server.pid()) + more_mb * kMegabyte, RLIM_INFINITY};
    ASSERT_EQ(prlimit(server.pid(), RLIMIT_AS, &cap, nullptr), 0);
    std::map<std::string, int> answers;
    const Cost cost = cost_of(std::to_string(more_mb) + " MB left", server, [&] {
      answers = answers_to_much(server.port());
      std::this_thread::sleep_for(std::chrono::milliseconds(300));  // refusals arrive at once
    });
    int all = 0;
    for (const auto& [what, count] : answers) {
      std::printf("   %s: %d\n", what.c_str(), count);
      all += count;
    }
    EXPECT_EQ(all, 10) << server.log();
    EXPECT_TRUE(more_mb > 100 || answers["too large"] > 0);
    expect_served(cost, 2000);
  }
  EXPECT_EQ(server.stop(SIGTERM), 0) << server.log();
}

}  // namespace
}  // namespace mirage::test
