#include "client/ask/server_pace.h"

#include <algorithm>
#include <vector>

#include "protocol/base/quantile.h"

namespace mirage {
namespace {

constexpr std::size_t kReplies = 17;
constexpr std::size_t kFirstReplies = 9;    // fewer tell nothing
constexpr std::int64_t kUnknownUs = 5000;   // for a tile, if the server has made none
constexpr double kLeast = 4, kMost = 4096;  // a server refuses more

std::size_t bounded(double n) { return static_cast<std::size_t>(std::clamp(n, kLeast, kMost)); }

}  // namespace

void ServerPace::expect(std::int64_t tile_us) { expected_us_ = tile_us; }

void ServerPace::tile_arrived(const TileTrip& trip) {
  const std::int64_t took = std::max<std::int64_t>(trip.came_us - trip.sent_us, 1);
  const std::int64_t server = std::clamp<std::int64_t>(trip.server_us, 0, took);
  last_.push_back({std::max<std::size_t>(trip.under_way, 1), took - server, server,
                   trip.came_us - took + server});
  if (last_.size() > kReplies) last_.pop_front();
}

std::int64_t ServerPace::server_us() const {
  std::vector<std::int64_t> waits;
  for (const Reply& reply : last_) waits.push_back(reply.server_us);
  return quantile(waits, 0.5);
}

double ServerPace::completes() const {
  std::vector<Reply> replies(last_.begin(), last_.end());
  std::sort(replies.begin(), replies.end(),
            [](const Reply& a, const Reply& b) { return a.finished_us < b.finished_us; });
  std::int64_t busy_us = 0;
  int finished = 0;
  for (std::size_t i = 1; i < replies.size(); ++i) {
    const std::int64_t since_us = replies[i].finished_us - replies[i - 1].finished_us;
    if (replies[i].server_us < since_us) continue;
    busy_us += since_us;
    ++finished;
  }
  return finished / static_cast<double>(std::max<std::int64_t>(busy_us, 1));
}

std::size_t ServerPace::limit(std::int64_t way_us, std::int64_t slack_us) {
  const std::int64_t tile_us = expected_us_ > 0 ? expected_us_ : kUnknownUs;
  const double unknown =
      (static_cast<double>(way_us) + static_cast<double>(slack_us)) / static_cast<double>(tile_us);
  if (last_.size() < kFirstReplies) return bounded(unknown);
  std::vector<std::int64_t> ways;
  for (const Reply& reply : last_) ways.push_back(reply.way_us);
  const double while_us = static_cast<double>(quantile(ways, 0.5)) + static_cast<double>(slack_us);
  const bool queued = 2 * server_us() >= slack_us;
  if (queued) {
    per_us_ = completes();
    return bounded(per_us_ * while_us);
  }
  std::size_t most = 0;
  for (const Reply& reply : last_) most = std::max(most, reply.under_way);
  // The rate if the server made one tile after the other, each in the time it had the last ones. It
  // may make several at a time.
  const double in_turn = while_us / static_cast<double>(std::max<std::int64_t>(server_us(), 1));
  const double known = per_us_ > 0 ? per_us_ * while_us : unknown;
  return bounded(std::max({known, in_turn, 2.0 * static_cast<double>(most)}));
}

}  // namespace mirage
