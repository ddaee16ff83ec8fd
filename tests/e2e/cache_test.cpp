// Cache directory, seen from outside: a restarted server finds what the former one made.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "tests/support/process.h"

namespace mirage::test {
namespace {
namespace fs = std::filesystem;

constexpr const char* kScene = "builtin:knot?tubular=60&radial=12";

std::vector<fs::path> files_in(const std::string& folder, const std::string& extension) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == extension) out.push_back(entry.path());
  }
  return out;
}

std::string revision_of(const Server& server) {
  const std::string log = server.log();
  const std::size_t at = log.find("revision=");
  return at == std::string::npos ? "" : log.substr(at, 25);
}

// One client on a fixed path, every tile decoded and checked.
Finished ask_tiles(const Server& server) {
  return run({binary("mirage-load"), server.url(), "--clients", "1", "--duration", "3", "--rate",
              "20", "--spread", "0", "--verify", "1"});
}

int rendered(const Server& server) {
  const std::string log = server.log();
  const std::size_t at = log.find("stopped: ");
  return at == std::string::npos ? -1 : std::atoi(log.c_str() + at + 9);
}

TEST(CacheDirectory, OutlivesTheServerAndMayBeDamaged) {
  const std::string folder = scratch_folder() + "/cache";
  std::string revision;
  std::map<std::string, int> tiles;
  std::map<std::string, std::size_t> kept;
  for (const char* round : {"made", "found", "damaged"}) {
    if (std::string(round) == "damaged") {
      for (const char* kind : {".lods", ".tile"}) {
        for (const fs::path& path : files_in(folder, kind)) fs::resize_file(path, 100);
      }
    }
    Server server(kScene, {"--cache-dir", folder});
    ASSERT_TRUE(server.ready()) << server.log();
    if (revision.empty()) revision = revision_of(server);
    EXPECT_EQ(revision_of(server), revision) << round;
    const Finished asked = ask_tiles(server);
    EXPECT_EQ(asked.exit_code, 0) << round << ": " << asked.output;
    EXPECT_EQ(server.stop(15), 0);
    tiles[round] = rendered(server);
    kept[round] = files_in(folder, ".tile").size();
    const std::string log = server.log();
    EXPECT_EQ(log.find("is damaged") != std::string::npos, std::string(round) == "damaged") << log;
  }
  EXPECT_GT(tiles["made"], 20);
  EXPECT_LT(tiles["found"], tiles["made"] / 4) << "when an ask is sent is up to the clock";
  EXPECT_LT(kept["found"] - kept["made"], kept["made"] / 4) << "what is rendered has the same name";
  EXPECT_GT(tiles["damaged"], tiles["made"] / 2);
  EXPECT_EQ(files_in(folder, ".lods").size(), 1u);
  EXPECT_FALSE(files_in(folder, ".tile").empty());
  EXPECT_TRUE(files_in(folder, ".part").empty());
}

}  // namespace
}  // namespace mirage::test
