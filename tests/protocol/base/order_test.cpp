// Sorting by one number: equals keep their order, and no number breaks it.
#include "protocol/base/order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <random>

namespace mirage {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

TEST(Order, EqualKeysKeepTheirOrderAndNanComesLast) {
  EXPECT_TRUE(ascending({}).empty());
  EXPECT_EQ(ascending({2, 0.0, 1, -0.0, 1}), (std::vector<std::size_t>{1, 3, 2, 4, 0}));
  EXPECT_EQ(ascending({kNoNumber, 3, -kEndless, 1e300}), (std::vector<std::size_t>{2, 1, 3, 0}));
}

TEST(Order, IsThatOfAStableSort) {
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    std::vector<std::pair<int, int>> items(random() % 300);
    for (std::size_t i = 0; i < items.size(); ++i)
      items[i] = {static_cast<int>(random() % 9), static_cast<int>(i)};
    auto up = items, down = items, stable_up = items, stable_down = items;
    sort_ascending(up, [](const auto& item) { return item.first; });
    sort_descending(down, [](const auto& item) { return item.first; });
    std::stable_sort(stable_up.begin(), stable_up.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::stable_sort(stable_down.begin(), stable_down.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    EXPECT_EQ(up, stable_up);
    EXPECT_EQ(down, stable_down);
  }
}

// Many keys that are no numbers would have std::sort leave its range.
TEST(Order, ManyNansAreSortedToo) {
  std::vector<double> keys(1000);
  for (std::size_t i = 0; i < keys.size(); ++i)
    keys[i] = i % 3 == 0 ? static_cast<double>(i % 7) : kNoNumber;
  std::vector<double> sorted = keys;
  sort_descending(sorted, [](double key) { return key; });
  EXPECT_EQ(sorted.front(), 6);
  EXPECT_FALSE(sorted.back() == sorted.back());
}

TEST(Order, MovesWhatCannotBeCopied) {
  std::vector<std::unique_ptr<int>> items;
  for (const int value : {3, 1, 2}) items.push_back(std::make_unique<int>(value));
  sort_ascending(items, [](const std::unique_ptr<int>& item) { return *item; });
  EXPECT_EQ(*items[0], 1);
  EXPECT_EQ(*items[2], 3);
}

}  // namespace
}  // namespace mirage
