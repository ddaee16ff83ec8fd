// A session through the relay has the round trip that the relay was told.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace mirage::test {
namespace {

TEST(Relay, ASessionThroughItHasItsRoundTrip) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string folder = scratch_folder();
  const auto latency_ms = [&](const std::string& shape) {
    const std::string script =
        binary("mirage-relay") + " --to " + std::to_string(server.port()) + " --port-file " +
        folder + "/port " + shape + " & relay=$!; until [ -s " + folder +
        "/port ]; do sleep .05; done; " + binary("mirage-load") + " ws://127.0.0.1:$(cat " +
        folder +
        "/port) --clients 4 --duration 3 --rate 4 --warm "
        "--path builtin:orbit --spread 2 --fps 5 --verify 1 --json " +
        folder + "/load.json; code=$?; kill $relay; rm " + folder + "/port; exit $code";
    const Finished done = run({"/bin/sh", "-c", script});
    EXPECT_EQ(done.exit_code, 0) << done.output;
    const auto told = nlohmann::json::parse(read_file(folder + "/load.json"), nullptr, false);
    EXPECT_EQ(told.value("verify_failures", -1), 0);
    return told["latency_ms"].value("p50", -1.0);
  };
  const double plain = latency_ms(""), far = latency_ms("--rtt 100");
  EXPECT_GE(plain, 0);
  EXPECT_LT(plain, 50);
  EXPECT_GT(far, 100);
  EXPECT_LT(far, 170);
}

// TCP with lost packets: everything arrives, but it takes longer.
TEST(Link, ASessionOverALossyLinkGetsWhatItAsksFor) {
  const std::string folder = scratch_folder();
  const auto through = [&](const std::string& shape) {
    const std::string server = "exec " + binary("mirage-server") +
                               " builtin:knot --listen 10.213.0.1:9870 --port-file " + folder +
                               "/port";
    const std::string clients = binary("mirage-load") +
                                " ws://10.213.0.1:9870 --clients 4 --duration 4 --rate 20 --warm "
                                "--spread 40 --verify 1 --json " +
                                folder + "/load.json";
    const Finished done = run({"/bin/sh", "-c",
                               "rm -f " + folder + "/port; exec " + binary("mirage-link") +
                                   " --far '" + server + "' --near '" + clients + "' --until " +
                                   folder + "/port --stats " + folder + "/link.json " + shape});
    return done;
  };
  const Finished first = through("--rtt 40");
  if (first.output.find("root's") != std::string::npos) GTEST_SKIP() << first.output;
  ASSERT_EQ(first.exit_code, 0) << first.output;
  const auto read = [&](const char* name) {
    return nlohmann::json::parse(read_file(folder + "/" + name), nullptr, false);
  };
  EXPECT_EQ(read("link.json")["down"].value("lost", -1), 0);
  EXPECT_GE(read("load.json")["latency_ms"].value("p50", -1.0), 40);
  const double plain_99 = read("load.json")["latency_ms"].value("p99", -1.0);
  const Finished lossy = through("--rtt 40 --loss 3 --reorder 2");
  ASSERT_EQ(lossy.exit_code, 0) << lossy.output;
  const nlohmann::json down = read("link.json")["down"], load = read("load.json");
  const double packets = down.value("packets", 0.0);
  EXPECT_GT(packets, 200);
  EXPECT_NEAR(down.value("lost", 0.0), 0.03 * packets, 5 * std::sqrt(0.03 * packets) + 1);
  EXPECT_GT(down.value("late", 0.0), 0);
  EXPECT_EQ(load.value("verify_failures", -1), 0);
  EXPECT_GT(load["latency_ms"].value("p99", -1.0), 1.3 * plain_99);
}

}  // namespace
}  // namespace mirage::test
