#include "client/core/server_pace.h"

#include <algorithm>
#include <vector>

#include "client/core/quantile.h"

namespace mirage {
namespace {

constexpr std::size_t kReplies = 9;
constexpr std::size_t kUnknown = 48;        // before there are so many replies; 5 ms each at most
constexpr double kLeast = 4, kMost = 4096;  // a server refuses more

}  // namespace

void ServerPace::tile_arrived(std::size_t under_way, std::int64_t trip_us, std::int64_t server_us) {
  const std::int64_t trip = std::max<std::int64_t>(trip_us, 1);
  const std::int64_t server = std::clamp<std::int64_t>(server_us, 0, trip);
  last_.push_back({std::max<std::size_t>(under_way, 1), trip - server, server});
  if (last_.size() > kReplies) last_.pop_front();
}

std::int64_t ServerPace::server_us() const {
  std::vector<std::int64_t> waits;
  for (const Reply& reply : last_) waits.push_back(reply.server_us);
  return quantile(waits, 0.5);
}

std::size_t ServerPace::limit(std::int64_t slack_us) {
  if (last_.size() < kReplies) return kUnknown;
  std::vector<std::int64_t> ways;
  for (const Reply& reply : last_) ways.push_back(reply.way_us);
  const auto way = static_cast<double>(quantile(ways, 0.5));
  const bool queued = 2 * server_us() >= slack_us;
  if (queued) per_us_ = 0;
  double most = 0;
  for (const Reply& reply : last_) {
    const auto n = static_cast<double>(reply.under_way);
    most = std::max(most, n);
    if (!queued) continue;
    const double took = std::max(way + static_cast<double>(reply.server_us), 1.0);
    per_us_ = std::max(per_us_, n / took);
  }
  const double while_us = way + static_cast<double>(slack_us);
  const double completes = per_us_ * while_us;
  // One after the other, each as long as it had the last ones: it may well make several at a time.
  const double in_turn = while_us / static_cast<double>(std::max<std::int64_t>(server_us(), 1));
  const double known = per_us_ > 0 ? completes : static_cast<double>(kUnknown);
  const double wanted = queued ? completes : std::max({known, in_turn, 2 * most});
  return static_cast<std::size_t>(std::clamp(wanted, kLeast, kMost));
}

}  // namespace mirage
