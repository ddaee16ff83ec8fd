// A session through the relay has the round trip that the relay was told.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace mirage::test
