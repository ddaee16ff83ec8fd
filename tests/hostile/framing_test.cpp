// Runs each case of the table with the shipped server, beside a well-behaved client.

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/hostile/beside.h"
#include "tests/hostile/client.h"
#include "tests/hostile/framing_table.h"

namespace mirage::test {
namespace {

constexpr const char* kProbe = "still there?";
constexpr int kProbeEveryMs = 150, kProbes = 8, kSilenceMs = 400;

/// Returns the server's answers until it answers two pings, closes, or stays silent. It takes two,
/// because a pong may come before the answer to what was said earlier.
std::string outcome(WebSocket& socket) {
  std::string out;
  int pongs = 0;
  for (int i = 0; i < kProbes; ++i) {
    socket.say(ClientFrame{9, kProbe});
    while (const std::optional<ServerFrame> frame = socket.next(kProbeEveryMs)) {
      if (frame->masked || frame->reserved != 0 || !frame->final) return out + "a wrong frame";
      if (frame->opcode == 8) return "closed " + std::to_string(frame->close_code());
      if (frame->opcode == 10 && frame->payload == kProbe) {
        if (++pongs == 2) return out + "open";
        break;
      }
      const bool pong = frame->opcode == 10;
      out += pong ? "pong " + std::to_string(frame->payload.size()) + ", " : "stats, ";
    }
    if (socket.ended()) return "dropped";
  }
  return out + "waits";
}

/// Returns what the server says or does at all.
std::string silence(WebSocket& socket) {
  const std::optional<ServerFrame> frame = socket.next(kSilenceMs);
  if (frame && frame->opcode == 8) return "closed " + std::to_string(frame->close_code());
  return frame ? "an answer" : socket.ended() ? "dropped" : "waits";
}

std::string outcome_of(const FramingCase& c, int port, const std::string& address) {
  Client client(port, "", PeerFrom{address});
  if (!client.greeted()) return "no welcome";
  for (const std::string& piece : c.said) client.socket().say(piece);
  return c.complete ? outcome(client.socket()) : silence(client.socket());
}

struct Suite {
  const char* name;
  std::vector<FramingCase> (*cases)();
};

class Framing : public ::testing::TestWithParam<Suite> {};

TEST_P(Framing, IsWhatTheStandardSays) {
  const Server server("builtin:knot?tubular=60&radial=12", {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  const std::vector<FramingCase> cases = GetParam().cases();
  std::vector<std::string> found(cases.size());
  const Cost cost = cost_of(std::string("framing, ") + GetParam().name, server, [&] {
    at_once(cases.size(), [&](std::size_t i) {
      found[i] = outcome_of(cases[i], server.port(), "127.1.0." + std::to_string(1 + i));
    });
  });
  int deviations = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    EXPECT_EQ(found[i], cases[i].comes_of_it) << cases[i].name << "; " << cases[i].why;
    deviations += cases[i].why.empty() ? 0 : 1;
  }
  std::printf("   %zu cases, %d of them not as the standard says\n", cases.size(), deviations);
  EXPECT_LT(cost.more_mb(), 24);
  expect_served(cost, 500);
}

INSTANTIATE_TEST_SUITE_P(
    Of, Framing,
    ::testing::Values(Suite{"opcodes", opcode_cases}, Suite{"control", control_cases},
                      Suite{"close", close_cases}, Suite{"lengths", length_cases},
                      Suite{"fragments", fragment_cases}, Suite{"chopped", chopped_cases},
                      Suite{"messages", message_cases}),
    [](const auto& suite) { return std::string(suite.param.name); });

}  // namespace
}  // namespace mirage::test
