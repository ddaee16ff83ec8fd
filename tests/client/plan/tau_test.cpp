// Tau controller: settles under delay, holds in the dead band, and ignores NaN.
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>

#include "client/plan/tau_controller.h"

namespace mirage {
namespace {

constexpr std::int64_t kRoundUs = 100'000;

TauLoad rate(double mbps) { return {mbps, 0}; }

TEST(CoreTau, RisesUnderLoadAndComesBack) {
  TauController c(1, {20});
  std::int64_t now = 0;
  for (int i = 0; i < 5; ++i) c.update(rate(40), now += kRoundUs, kRoundUs);
  EXPECT_NEAR(c.tau_px(), std::pow(1.25, 5), 1e-9);
  for (int i = 0; i < 2; ++i) c.update(rate(5), now += kRoundUs, kRoundUs);
  EXPECT_NEAR(c.tau_px(), std::pow(1.25, 5), 1e-9) << "coming back takes calm";
  for (int i = 0; i < 20; ++i) c.update(rate(5), now += kRoundUs, kRoundUs);
  EXPECT_EQ(c.tau_px(), 1);
}

TEST(CoreTau, OneStepARoundTripAndABound) {
  TauController c(1, {20});
  for (int i = 0; i < 99; ++i) c.update(rate(100), 1000 + i, kRoundUs);
  EXPECT_NEAR(c.tau_px(), 1.25, 1e-12);
  for (int i = 1; i < 99; ++i) c.update(rate(100), i * kRoundUs + 1000, kRoundUs);
  EXPECT_EQ(c.tau_px(), 16);
}

TEST(CoreTau, DeadBandHolds) {
  TauController c(1, {5});
  std::int64_t now = 0;
  c.update({10, 0}, now += kRoundUs, kRoundUs);
  const double held = c.tau_px();
  EXPECT_GT(held, 1);
  for (const double rate : {4.6, 5.4, 4.9, 5.2, 4.6, 5.4, 4.6, 4.6, 4.6, 4.6}) {
    EXPECT_EQ(c.update({rate, 0}, now += kRoundUs, kRoundUs), held);
  }
}

TEST(CoreTau, WhatIsNoNumberHolds) {
  TauController c(1, {20});
  c.update(rate(100), kRoundUs, kRoundUs);
  const double held = c.tau_px();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::int64_t now = kRoundUs;
  EXPECT_EQ(c.update({nan, 0}, now += kRoundUs, kRoundUs), held);
  EXPECT_EQ(c.update({100, INFINITY}, now += kRoundUs, kRoundUs), held);
}

TEST(CoreTau, ALinkFullForLongRaisesIt) {
  TauController c(2, {});
  EXPECT_EQ(c.update({0, 0.5}, kRoundUs, kRoundUs), 2);
  EXPECT_EQ(c.update({0, 1.5}, 2 * kRoundUs, kRoundUs), 2.5);
}

// A link whose load falls with tau and shows that some rounds late. The controller knows the
// round-trip time, so no limit cycle remains but one step either way.
TEST(CoreTau, SettlesUnderDelay) {
  for (const int delay : {0, 1, 3, 6}) {
    TauController c(0.25, {20});
    std::deque<double> late(static_cast<std::size_t>(delay) + 1, 20.0);
    std::int64_t now = 0;
    std::vector<double> taus;
    for (int i = 0; i < 100 * (delay + 1); ++i) {
      late.push_back(20.0 + 30.0 * (1.0 / c.tau_px() - 0.9));  // 20 Mbit/s at tau 1.11
      taus.push_back(c.update(rate(late.front()), now += kRoundUs, kRoundUs * (delay + 2)));
      late.pop_front();
    }
    const auto [low, high] = std::minmax_element(taus.end() - 50, taus.end());
    EXPECT_LE(*high / *low, 1.57) << "delay " << delay;
    EXPECT_GT(*low, 0.7) << "delay " << delay;
    EXPECT_LT(*high, 1.8) << "delay " << delay;
  }
}

// A link that is full below some tau, and shows that a round trip late. Even on a long way each
// descent in vain makes the next one later.
TEST(CoreTau, ALongWayTurnsSeldom) {
  constexpr std::int64_t kLongUs = 2'000'000;
  TauController c(1, {});
  double late = 1;
  int turns = 0, last_step = 0;
  for (int round = 0; round < 60; ++round) {
    const double before = c.tau_px();
    c.update({0, late < 4 ? 2.0 : 0.0}, (round + 1) * kLongUs, kLongUs);
    late = before;
    const int step = c.tau_px() > before ? 1 : c.tau_px() < before ? -1 : 0;
    if (step == 0) continue;
    turns += round >= 30 && step == -last_step ? 1 : 0;
    last_step = step;
  }
  EXPECT_LE(turns, 4);
}

}  // namespace
}  // namespace mirage
