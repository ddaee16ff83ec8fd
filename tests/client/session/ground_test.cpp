// Ground that a walker needs: a few blocks at a time, each asked for once.
#include <gtest/gtest.h>

#include "client/scene/ground_map.h"
#include "client/session/ground_asks.h"

namespace mirage::test {
namespace {

struct Asking {
  Asking() { map.reset({1.7}); }
  /// Asks for what is missing around the middle of block (0, 0); returns the blocks.
  std::vector<GroundBlockId> ask(std::int64_t now_us) {
    const double middle = 0.5 * map.body().block_m();
    std::vector<GroundBlockId> out = stage.plan(map, middle, middle, now_us);
    for (const GroundBlockId& id : out) stage.asked(++number, id);
    return out;
  }
  GroundMap map;
  GroundAsks stage;
  std::uint32_t number = 0;
};

GroundBlock empty_block(GroundBlockId id) {
  GroundBlock out;
  out.id = id;
  out.counts.assign(std::size_t{kGroundCells} * kGroundCells, 0);
  return out;
}

TEST(ClientGroundAsks, TheNearestBlocksComeFirstAndEachOnce) {
  Asking a;
  const std::vector<GroundBlockId> first = a.ask(0);
  ASSERT_EQ(first.size(), 4u);
  EXPECT_EQ(first[0], (GroundBlockId{0, 0}));
  EXPECT_TRUE(a.ask(1).empty()) << "four are under way";
  EXPECT_FALSE(a.stage.finish(1, {5, 5})) << "another block";
  EXPECT_FALSE(a.stage.finish(77, first[0])) << "never asked for";
  ASSERT_TRUE(a.stage.finish(1, first[0]));
  EXPECT_FALSE(a.stage.finish(1, first[0])) << "twice";
  a.map.add(empty_block(first[0]));
  const std::vector<GroundBlockId> more = a.ask(2);
  ASSERT_EQ(more.size(), 1u);
  for (const GroundBlockId& id : first) EXPECT_FALSE(more[0] == id);
}

TEST(ClientGroundAsks, ARefusalPausesAndANewConnectionAsksAgain) {
  Asking a;
  const std::vector<GroundBlockId> first = a.ask(0);
  ASSERT_TRUE(a.stage.refused(2, 1000));
  EXPECT_FALSE(a.stage.refused(2, 1000)) << "it is not for ground any more";
  EXPECT_TRUE(a.ask(2000).empty());
  const std::vector<GroundBlockId> again = a.ask(1'500'000);
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0], first[1]);
  a.stage.reset();
  EXPECT_EQ(a.ask(1'600'000).size(), 4u);
}

TEST(ClientGroundAsks, WhereNobodyWalksNothingIsAskedFor) {
  Asking a;
  a.map.reset({});
  EXPECT_TRUE(a.ask(0).empty());
  a.map.reset({1.7});
  EXPECT_TRUE(a.stage.plan(a.map, std::nan(""), 0, 0).empty());
}

}  // namespace
}  // namespace mirage::test
