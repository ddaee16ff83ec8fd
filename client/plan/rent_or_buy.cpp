#include "client/plan/rent_or_buy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mirage {
namespace {
// An object seen for a moment only counts as being seen for at least this long, s. Nobody plans
// farther than the second value.
constexpr double kLeastHorizonS = 4, kFarthestHorizonS = 60;
constexpr double kShortestLifeS = 0.05;
// Time without being seen or used after which an object is forgotten.
constexpr std::int64_t kForgottenUs = 10'000'000;
constexpr std::int64_t kRecentUs = kForgottenUs;
// With more objects, each of which is small, geometry would mostly add draws.
constexpr std::size_t kFewObjects = 8;
}  // namespace

void RentOrBuy::paid(std::uint32_t object, double bytes) {
  if (object < accounts_.size()) accounts_[object].paid += bytes;
}

double RentOrBuy::horizon_s(const Account& account, std::int64_t now_us) const {
  const double seen_s = 1e-6 * static_cast<double>(now_us - account.since_us);
  return std::clamp(seen_s, kLeastHorizonS, kFarthestHorizonS);
}

void RentOrBuy::want(std::uint32_t object, const Wanted& tile, std::int64_t now_us) {
  if (object >= accounts_.size() || !std::isfinite(tile.bytes) || !std::isfinite(tile.life_s))
    return;
  Account& account = accounts_[object];
  if (now_us - account.seen_us > kForgottenUs) {
    const bool recent = account.recent;
    account = Account{};
    account.recent = recent;
    account.since_us = now_us;
  }
  account.seen_us = now_us;
  if (account.wanted == 0) {
    told_.push_back(object);
    account.worth = account.price = 0;
  }
  const double times =
      std::max(horizon_s(account, now_us) / std::max(tile.life_s, kShortestLifeS), 1.0);
  account.wanted += tile.bytes * times;
  account.worth += tile.gain * times;
  account.price = std::max(account.price, tile.price_bytes);
}

bool RentOrBuy::bought(std::uint32_t object, std::int64_t now_us) const {
  const Account& account = accounts_[object];
  return account.bought_us >= 0 && now_us - account.bought_us <= kForgottenUs;
}

double RentOrBuy::worth_a_byte(std::uint32_t object) const {
  const Account& account = accounts_[object];
  return account.price > 0 ? account.worth / account.price
                           : std::numeric_limits<double>::infinity();
}

void RentOrBuy::used(std::uint32_t object, std::int64_t now_us) {
  if (bought(object, now_us)) accounts_[object].bought_us = now_us;
}

double RentOrBuy::price_of_recent(std::int64_t now_us) {
  const auto is_old = [&](std::uint32_t object) {
    const bool old = now_us - accounts_[object].seen_us > kRecentUs;
    if (old) accounts_[object].recent = false;
    return old;
  };
  recent_.erase(std::remove_if(recent_.begin(), recent_.end(), is_old), recent_.end());
  for (const std::uint32_t object : told_) {
    if (!accounts_[object].recent) recent_.push_back(object);
    accounts_[object].recent = true;
  }
  double bytes = 0;
  for (const std::uint32_t object : recent_) {
    if (!bought(object, now_us)) bytes += accounts_[object].price;
  }
  return bytes;
}

void RentOrBuy::decide(std::int64_t now_us, double spare_bytes) {
  const bool spare = price_of_recent(now_us) <= spare_bytes && recent_.size() <= kFewObjects;
  for (const std::uint32_t object : told_) {
    Account& account = accounts_[object];
    const bool due = account.paid + account.wanted >= account.price;
    if (account.wanted > 0 && (due || spare)) {
      account.bought_us = now_us;
      account.paid = 0;
    }
    account.wanted = 0;
  }
  told_.clear();
}

}  // namespace mirage
