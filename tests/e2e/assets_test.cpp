// Every shared asset through the shipped binaries: valid files are served and drawn, broken ones
// end as their manifest says.

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "tests/support/process.h"

namespace mirage::test {
namespace {

using Row = std::map<std::string, std::string>;

std::vector<Row> manifest(const std::string& path) {
  std::ifstream file(path);
  std::vector<Row> rows;
  std::vector<std::string> names;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream in(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(in, cell, '\t');) cells.push_back(cell);
    if (names.empty()) {
      names = cells;
      continue;
    }
    Row row;
    for (std::size_t i = 0; i < names.size() && i < cells.size(); ++i) row[names[i]] = cells[i];
    rows.push_back(row);
  }
  return rows;
}

/// One of kShares shares of a manifest's files. Tests of shares run side by side.
class Assets : public ::testing::TestWithParam<int> {
 protected:
  static constexpr int kShares = 4;
  static std::vector<Row> share_of(const std::string& path) {
    std::vector<Row> out;
    const std::vector<Row> all = manifest(path);
    for (std::size_t i = static_cast<std::size_t>(GetParam()); i < all.size(); i += kShares) {
      out.push_back(all[i]);
    }
    return out;
  }
};

TEST_P(Assets, ValidFilesServeAndDraw) {
  const std::string shared = shared_folder();
  if (!std::ifstream(shared + "/assets/MANIFEST.tsv"))
    GTEST_SKIP() << "the sweep is over the assets of ../shared, which is not beside the checkout";
  int drawn = 0;
  for (const Row& row : share_of(shared + "/assets/MANIFEST.tsv")) {
    const std::string& name = row.at("file");
    const std::string required =
        row.count("extensions_required") ? row.at("extensions_required") : "";
    const bool needs_libdraco = required.find("draco") != std::string::npos;  // an optional library
    const Server server(shared + "/assets/" + name);
    if (needs_libdraco && !server.ready()) {
      EXPECT_NE(server.log().find("error scene-extension:"), std::string::npos) << server.log();
      continue;
    }
    ASSERT_TRUE(server.ready()) << name << ": " << server.log();
    const Finished view = run({binary("mirage-view"), server.url(), "--offscreen", "96x64",
                               "--path", "builtin:orbit", "--frames", "25", "--virtual-time",
                               "--net", "rtt=20,server-ms=1", "--msaa", "0", "--atlas-mb", "40"});
    EXPECT_EQ(view.exit_code, 0) << name << ": " << view.output;
    EXPECT_EQ(server.log().find("GL error"), std::string::npos) << name << ": " << server.log();
    ++drawn;
  }
  EXPECT_GT(drawn, 100 / kShares);
}

TEST_P(Assets, BrokenFilesEndAsTheirManifestExpects) {
  const std::string shared = shared_folder();
  if (!std::ifstream(shared + "/assets_broken/MANIFEST.tsv"))
    GTEST_SKIP() << "the sweep is over the files of ../shared, which is not beside the checkout";
  int checked = 0;
  for (const Row& row : share_of(shared + "/assets_broken/MANIFEST.tsv")) {
    const std::string& name = row.at("file");
    const std::string& expected = row.at("expected");
    const Finished done =
        run({"/bin/sh", "-c",
             "ulimit -v 4000000 2>/dev/null; ulimit -t 5; exec \"$0\" \"$1\" --explain",
             binary("mirage-server"), shared + "/assets_broken/" + name},
            60);  // it has 5 s of a core, however busy the machine is
    EXPECT_TRUE(done.exit_code == 0 || done.exit_code == 3)
        << name << ": " << done.exit_code << " " << done.output;
    if (done.exit_code == 3) {
      EXPECT_NE(done.output.find("error scene-"), std::string::npos) << name << ": " << done.output;
    }
    const bool must_fail = expected == "error" || expected.rfind("error,", 0) == 0;
    const bool must_load = expected == "loads";
    if (must_fail) {
      EXPECT_EQ(done.exit_code, 3) << name << ": " << done.output;
    }
    if (must_load) {
      EXPECT_EQ(done.exit_code, 0) << name << ": " << done.output;
    }
    ++checked;
  }
  EXPECT_GT(checked, 200 / kShares);
}

INSTANTIATE_TEST_SUITE_P(Shares, Assets, ::testing::Range(0, 4));

}  // namespace
}  // namespace mirage::test
