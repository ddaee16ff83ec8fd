// Keeping things under a budget, and waiting for things that are being made.
#include <gtest/gtest.h>

#include <string>

#include "server/base/byte_budget.h"
#include "server/base/wait_list.h"

namespace mirage::test {
namespace {

TEST(ByteBudget, WhatWasUsedLongestAgoGoesFirst) {
  ByteBudget<std::string> budget(100);
  const auto a = budget.add("a", 40);
  budget.add("b", 40);
  budget.touch(a);
  EXPECT_FALSE(budget.take_excess());
  budget.add("c", 40);
  EXPECT_EQ(budget.take_excess(), "b");
  EXPECT_EQ(budget.bytes(), 80u);
  EXPECT_FALSE(budget.take_excess());
}

TEST(ByteBudget, WhatGrowsIsCountedAndOneAlwaysStays) {
  ByteBudget<std::string> budget(100);
  const auto a = budget.add("a", 10);
  const auto b = budget.add("b", 10);
  budget.grow(a, 500);
  budget.touch(a);
  EXPECT_EQ(budget.take_excess(), "b");
  EXPECT_FALSE(budget.take_excess()) << "it is over, and alone";
  EXPECT_EQ(budget.bytes(), 510u);
  static_cast<void>(b);
}

TEST(WaitList, TheFirstWhoWaitsHasItMadeAndAllAreServed) {
  WaitList<int, std::string> list;
  EXPECT_TRUE(list.add(1, "first"));
  EXPECT_FALSE(list.add(1, "second"));
  EXPECT_TRUE(list.add(2, "other"));
  EXPECT_EQ(list.size(), 3u);
  EXPECT_EQ(list.take(1), (std::vector<std::string>{"first", "second"}));
  EXPECT_TRUE(list.take(1).empty());
  EXPECT_FALSE(list.under_way(1));
  EXPECT_EQ(list.size(), 1u);
}

TEST(WaitList, WhatIsMadeForNobodyIsUnderWay) {
  WaitList<int, std::string> list;
  EXPECT_TRUE(list.begin(1));
  EXPECT_FALSE(list.begin(1));
  EXPECT_FALSE(list.add(1, "late"));
  EXPECT_TRUE(list.any(1, [](const std::string& who) { return who == "late"; }));
  EXPECT_FALSE(list.any([](const std::string& who) { return who == "nobody"; }));
}

TEST(WaitList, WhatNobodyWaitsForIsForgottenOnlyWhereItIsUnwanted) {
  WaitList<int, std::string> list;
  list.add(1, "a");
  list.add(2, "a");
  list.add(3, "a");
  list.add(3, "b");
  list.begin(4);
  std::vector<int> asked;
  list.remove([](const std::string& who) { return who == "a"; },
              [&](int key) {
                asked.push_back(key);
                return key == 1;
              });
  EXPECT_EQ(asked, (std::vector<int>{1, 2})) << "3 has another, for 4 nobody has waited";
  EXPECT_FALSE(list.under_way(1));
  EXPECT_TRUE(list.under_way(2) && list.under_way(3) && list.under_way(4));
  EXPECT_EQ(list.size(), 1u);
}

}  // namespace
}  // namespace mirage::test
