#include "client/load/reconnects.h"

#include <algorithm>
#include <cmath>

#include "client/load/request_plan.h"

namespace mirage {
namespace {
constexpr double kFirstPauseUs = 10'000, kLongestPauseUs = 1'000'000;
}  // namespace

void Reconnects::lost(std::uint32_t client, std::int64_t now_us) {
  Away& away = away_.try_emplace(client, Away{now_us, 0}).first->second;
  const double pause = std::min(kFirstPauseUs * std::exp2(away.tries), kLongestPauseUs / 2);
  const double chance = seeded_share(seed_, client, static_cast<std::uint64_t>(now_us));
  ++away.tries;
  tries_.emplace(now_us + std::llround(pause * (1 + chance)), client);
}

std::vector<std::uint32_t> Reconnects::take_due(std::int64_t now_us) {
  std::vector<std::uint32_t> out;
  while (!tries_.empty() && tries_.begin()->first <= now_us) {
    out.push_back(tries_.begin()->second);
    tries_.erase(tries_.begin());
  }
  return out;
}

std::optional<double> Reconnects::back(std::uint32_t client, std::int64_t now_us) {
  const auto away = away_.extract(client);
  if (away.empty()) return std::nullopt;
  return static_cast<double>(now_us - away.mapped().since_us) * 1e-3;
}

}  // namespace mirage
