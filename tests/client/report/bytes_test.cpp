// Bytes of walks: which deliveries are compared, and what is said about them.
#include <gtest/gtest.h>

#include <set>

#include "client/report/bytes_rows.h"

namespace mirage::test {
namespace {

BytesRun run(const std::string& delivery, double mb, double flip, int walk_s = 10) {
  BytesRun run;
  run.scene = "forest";
  run.delivery = delivery;
  run.walk_s = walk_s;
  run.mb = mb;
  run.flip_mean = flip;
  return run;
}

TEST(Bytes, MirageIsBesideTheLesserOfThoseWithAsGoodAPicture) {
  const std::vector<BytesRun> runs = {run("auto", 3, 0.05), run("auto within 50 ms", 2, 0.075),
                                      run("geometry", 6, 0.03), run("tiles", 1.5, 0.08)};
  const std::vector<BytesBeside> beside = bytes_beside(runs);
  ASSERT_EQ(beside.size(), 2u);
  EXPECT_EQ(beside[0].mirage, &runs[0]);
  EXPECT_EQ(beside[0].better, &runs[2]) << "tiles take less, for a worse picture";
  EXPECT_EQ(beside[1].better, &runs[3]);
  const Table table = bytes_table(runs);
  const std::size_t ratio = table.column("over_better"), better = table.column("better");
  EXPECT_EQ(table.rows()[0][ratio], "0.5");
  EXPECT_EQ(table.rows()[0][better], "geometry");
  EXPECT_EQ(table.rows()[2][ratio], "n/a");
}

TEST(Bytes, WalksOfOtherLengthsAreNotBesideEachOther) {
  const std::vector<BytesRun> runs = {run("auto", 3, 0.05, 10), run("tiles", 1, 0.05, 60)};
  ASSERT_EQ(bytes_beside(runs).size(), 1u);
  EXPECT_EQ(bytes_beside(runs)[0].better, nullptr);
  EXPECT_NE(bytes_words(runs)[0].find("neither"), std::string::npos);
}

TEST(Bytes, EveryWalkHasComparedSecondsAndTheLastIsOne) {
  for (const bool quick : {false, true}) {
    const BytesPlan plan = bytes_plan(quick);
    std::set<std::string> names;
    for (const Delivery& delivery : plan.deliveries) names.insert(delivery.name);
    EXPECT_EQ(names, (std::set<std::string>{"auto", "auto within 50 ms", "geometry", "tiles"}));
    for (const int walk : plan.walks_s) {
      const std::vector<int> seconds = compared_seconds(walk);
      EXPECT_GE(seconds.size(), 5u);
      EXPECT_GE(seconds.front(), 1);
      EXPECT_EQ(seconds.back(), walk);
    }
  }
}

}  // namespace
}  // namespace mirage::test
