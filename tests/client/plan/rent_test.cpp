// Rent or buy: never costs much more than the better choice, whichever that turns out to be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/plan/rent_or_buy.h"

namespace mirage {
namespace {

constexpr double kTile = 2000;
constexpr double kWorth = 100;  // of a tile
constexpr std::int64_t kRentFrameUs = 100'000;

double seconds_of(std::int64_t us) { return 1e-6 * static_cast<double>(us); }

/// Returns the bytes for an object that is seen for `seconds`. It has `instances` that each want a
/// new tile every `life_s`, and geometry of `price` bytes.
double bytes_of(int instances, double life_s, double price, double seconds) {
  RentOrBuy account;
  account.reset(1);
  double bytes = 0;
  std::vector<double> due(instances, 0);
  for (std::int64_t now = 0; seconds_of(now) < seconds; now += kRentFrameUs) {
    int wanted = 0;
    for (double& at : due) {
      if (at > seconds_of(now)) continue;
      account.want(0, {kTile, life_s, price, kWorth}, now);
      ++wanted;
      at = seconds_of(now) + life_s;
    }
    account.decide(now);
    if (account.bought(0, now)) return bytes + price;
    account.paid(0, wanted * kTile);
    bytes += wanted * kTile;
  }
  return bytes;
}

TEST(CoreRent, CostsAtMostTwiceTheBetterOfBoth) {
  for (const int instances : {1, 10, 100}) {
    for (const double life_s : {0.1, 0.5, 4.0}) {
      for (const double price : {1e3, 1e5, 1e6, 1e7}) {
        for (const double seconds : {5.0, 20.0, 60.0}) {
          const double rent = instances * kTile * std::ceil(seconds / std::max(life_s, 0.1));
          const double better = std::min(rent, price);
          EXPECT_LE(bytes_of(instances, life_s, price, seconds), 2 * better + instances * kTile)
              << instances << " instances, tiles for " << life_s << " s, " << price << " bytes, "
              << seconds << " s";
        }
      }
    }
  }
}

TEST(CoreRent, WhatManyInstancesShareIsBoughtAtOnce) {
  EXPECT_EQ(bytes_of(100, 0.5, 70e3, 10), 70e3) << "a species of trees";
  EXPECT_GT(bytes_of(1, 4, 2e6, 10), 0);
  EXPECT_LT(bytes_of(1, 4, 2e6, 10), 10e3) << "a heavy sculpture, looked at from where one stands";
}

TEST(CoreRent, WhatIsNotSeenAnyMoreIsForgotten) {
  RentOrBuy account;
  account.reset(2);
  account.want(0, {kTile, 1, 1, kWorth}, 0);
  account.decide(0);
  EXPECT_TRUE(account.bought(0, 0));
  EXPECT_FALSE(account.bought(1, 0));
  account.used(0, 8'000'000);
  EXPECT_TRUE(account.bought(0, 16'000'000));
  EXPECT_FALSE(account.bought(0, 19'000'000));
  account.used(0, 19'000'000);
  EXPECT_FALSE(account.bought(0, 19'000'000)) << "it has to be bought again";
}

TEST(CoreRent, NonsenseIsHarmless) {
  RentOrBuy account;
  account.reset(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  account.want(7, {kTile, 1, 1, kWorth}, 0);
  account.paid(7, 1);
  account.want(0, {nan, 1, 1e9, kWorth}, 0);
  account.want(0, {kTile, nan, 1e9, kWorth}, 0);
  account.want(0, {kTile, -1, 1e9, kWorth}, 0);
  account.want(0, {kTile, 0, 1e9, kWorth}, INT64_MAX / 2);
  account.decide(0);
  EXPECT_FALSE(account.bought(0, 0));
}

}  // namespace
}  // namespace mirage
