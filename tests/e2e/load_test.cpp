// mirage-load against a server: latency, verification, merging of equal requests.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace mirage::test {
namespace {

TEST(Load, ManyClientsGetVerifiedTiles) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string json = scratch_folder() + "/load.json";
  const Finished load = run({binary("mirage-load"), server.url(), "--clients", "50", "--duration",
                             "3", "--path", "builtin:orbit", "--rate", "4", "--verify", "1",
                             "--warm", "--spread", "2", "--fps", "5", "--json", json});
  ASSERT_EQ(load.exit_code, 0) << load.output;
  std::ifstream file(json);
  const nlohmann::json j = nlohmann::json::parse(file);
  for (const char* key : {"clients", "connected", "duration_s", "tiles", "tiles_per_s", "bytes",
                          "latency_ms", "errors", "verified", "verify_failures"}) {
    EXPECT_TRUE(j.contains(key)) << key;
  }
  EXPECT_EQ(j["connected"], 50);
  EXPECT_GT(j["tiles"], 300);
  EXPECT_EQ(j["verify_failures"], 0);
  EXPECT_GT(j["verified"], 300);
}

TEST(Load, EqualAsksCostOneRendering) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string json = scratch_folder() + "/load.json";
  // The camera stands still: every client asks for the same tile again and again.
  const Finished load = run({binary("mirage-load"), server.url(), "--clients", "20", "--duration",
                             "2", "--path", "builtin:still", "--rate", "5", "--json", json});
  ASSERT_EQ(load.exit_code, 0) << load.output;
  std::ifstream file(json);
  const nlohmann::json j = nlohmann::json::parse(file);
  EXPECT_GT(j["tiles"], 100);
  EXPECT_EQ(j["server"]["tiles_rendered"], 1) << j.dump(2);
}

// The link fails while clients ask, and is back only after mirage-load has given up.
TEST(Load, TilesThatComeTooLateAreCountedAsLate) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string folder = scratch_folder();
  const std::string script =
      binary("mirage-relay") + " --to " + std::to_string(server.port()) + " --port-file " + folder +
      "/port --outage-at 4 --outage-for 11 & relay=$!; until [ -s " + folder +
      "/port ]; do sleep .05; done; " + binary("mirage-load") + " ws://127.0.0.1:$(cat " + folder +
      "/port) --duration 6 --rate 4 --path builtin:orbit --json " + folder +
      "/load.json; code=$?; kill $relay; exit $code";
  const Finished load = run({"/bin/sh", "-c", script});
  ASSERT_EQ(load.exit_code, 0) << load.output;
  const nlohmann::json j = nlohmann::json::parse(read_file(folder + "/load.json"));
  const int unanswered = j["errors"].value("no-answer", 0);
  EXPECT_GT(j["late"], 0) << j.dump(2);
  EXPECT_LE(j["late"], unanswered) << j.dump(2);  // mirage-load does not stay for all of them
  EXPECT_EQ(j["tiles"].get<int>() + unanswered, j["asked"]) << j.dump(2);
  EXPECT_FALSE(j["errors"].contains("unexpected-tile")) << j.dump(2);
  EXPECT_GT(j["late_ms"]["p50"], 5000) << j.dump(2);
}

// A file without lights stands in surroundings, which the server describes before the scene.
TEST(Load, ASceneWithSurroundings) {
  const Server server("builtin:knot", {"--environment", "builtin:studio"});
  ASSERT_TRUE(server.ready()) << server.log();
  const Finished load = run({binary("mirage-load"), server.url(), "--clients", "2", "--duration",
                             "1", "--rate", "4", "--verify", "1", "--path", "builtin:orbit"});
  EXPECT_EQ(load.exit_code, 0) << load.output;
}

}  // namespace
}  // namespace mirage::test
