#include "client/core/ask_window.h"

#include <algorithm>
#include <vector>

#include "client/core/quantile.h"

namespace mirage {
namespace {

constexpr double kInitialBytes = 256 * 1024;
constexpr double kLeastBytes = 16 * 1024;
constexpr std::int64_t kSlackUs = 25'000;  // and 25 for frames and a tile's own time on the link
constexpr std::int64_t kRateSpanUs = 1'000'000;
constexpr std::int64_t kShortestSpanUs = 200'000;
constexpr int kSpanTrips = 4;  // the rate is measured over so many
constexpr std::size_t kLeastArrivals = 4;
constexpr std::size_t kFirstArrivals = 8;  // before them nothing is known
constexpr std::size_t kTrips = 33;
constexpr std::size_t kQueueTrips = 8;  // the shortest of so many is above a queue, if there is one
constexpr std::int64_t kPeriodUs = 5'000'000;
constexpr int kPeriodTrips = 20;
constexpr int kFreeTrips = 4;  // without a queue: the window holds the rate down
constexpr int kDrainTrips = 3;
constexpr double kLargestGain = 2;
constexpr double kProbingGain = 1.1;  // nothing has told where the limit is now

}  // namespace

void AskWindow::reset() {
  arrivals_.clear();
  shortest_us_ = {INT64_MAX, INT64_MAX};
  best_rates_ = {};
  period_ends_us_ = queued_us_ = drain_until_us_ = 0;
  met_limit_ = false;
  window_ = 0;
}

void AskWindow::arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes,
                        double expected) {
  // A large reply arrives at once, but its bytes took their time: since the one before it, at the
  // earliest a round trip after it was asked for.
  std::int64_t since = std::min(sent_us + shortest_trip_us(), now_us);
  if (!arrivals_.empty()) since = std::max(since, arrivals_.back().at_us);
  arrivals_.push_back({since, now_us, bytes, expected});
}

void AskWindow::tile_arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes,
                             double expected) {
  const std::int64_t trip = std::max<std::int64_t>(now_us - sent_us, 0);
  shortest_us_[0] = std::min(shortest_us_[0], trip);
  trips_us_.push_back(trip);
  if (trips_us_.size() > kTrips) trips_us_.pop_front();
  arrived(sent_us, now_us, bytes, expected);
}

void AskWindow::asset_arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes,
                              double expected) {
  arrived(sent_us, now_us, bytes, expected);
}

std::int64_t AskWindow::shortest_trip_us() const {
  const std::int64_t shortest = std::min(shortest_us_[0], shortest_us_[1]);
  return shortest == INT64_MAX ? 0 : shortest;
}

bool AskWindow::queued() const {
  if (trips_us_.size() < kQueueTrips) return false;
  const auto first = trips_us_.end() - static_cast<std::ptrdiff_t>(kQueueTrips);
  return *std::min_element(first, trips_us_.end()) > shortest_trip_us() + kSlackUs / 2;
}

double AskWindow::measured_rate(std::int64_t now_us) const {
  const std::int64_t span =
      std::clamp(kSpanTrips * (shortest_trip_us() + kSlackUs), kShortestSpanUs, kRateSpanUs);
  double received = 0;
  std::int64_t first = now_us;
  std::size_t count = 0;
  for (auto at = arrivals_.rbegin(); at != arrivals_.rend(); ++at, ++count) {
    if (count >= kLeastArrivals && at->at_us < now_us - span) break;
    received += at->expected;
    first = std::min(first, at->since_us);
  }
  return received / static_cast<double>(std::max<std::int64_t>(now_us - first, 20'000));
}

void AskWindow::turn_period(std::int64_t now_us, std::int64_t held_back_us) {
  const std::int64_t length = std::max(kPeriodUs, kPeriodTrips * shortest_trip_us());
  if (period_ends_us_ != 0 && now_us < period_ends_us_) return;
  // Under load all the time: no trip of this period was without a queue.
  if (period_ends_us_ != 0 && held_back_us >= length) {
    drain_until_us_ = now_us + kDrainTrips * (shortest_trip_us() + kSlackUs);
  }
  shortest_us_ = {INT64_MAX, shortest_us_[0]};
  std::rotate(best_rates_.begin(), best_rates_.end() - 1, best_rates_.end());
  best_rates_[0] = 0;
  period_ends_us_ = now_us + length;
}

double AskWindow::update(std::int64_t now_us, std::int64_t held_back_us, bool idle) {
  while (!arrivals_.empty() && arrivals_.front().at_us < now_us - kRateSpanUs) {
    arrivals_.pop_front();
  }
  turn_period(now_us, held_back_us);
  if (idle) drain_until_us_ = 0;
  if (now_us < drain_until_us_) return 0;
  // Little came because little was asked for: that says nothing about the link.
  const double proven = std::min(window_, kInitialBytes);
  if (arrivals_.size() < kFirstArrivals && (idle || held_back_us < kRateSpanUs)) {
    return window_ = window_ > 0 ? proven : kInitialBytes;
  }
  const double rate = measured_rate(now_us);
  best_rates_[0] = std::max(best_rates_[0], rate);
  const std::int64_t trip = shortest_trip_us() + kSlackUs;
  double gain = 1;
  if (queued()) {
    met_limit_ = true;
    queued_us_ = now_us;
    best_rates_ = {rate};  // with a queue, what comes is what the link can do now
  } else if (!met_limit_) {
    gain = kLargestGain;
  } else if (now_us - queued_us_ > kFreeTrips * trip) {
    const double best = *std::max_element(best_rates_.begin(), best_rates_.end());
    gain = std::clamp(best / std::max(rate, 1e-9), kProbingGain, kLargestGain);
  }
  const double wanted = gain * rate * static_cast<double>(trip);
  const double measured = std::max(kLeastBytes, wanted);
  window_ = held_back_us == 0 ? std::max(measured, proven) : measured;
  return window_;
}

double AskWindow::rate_mbps() const {
  double bytes = 0;
  for (const Arrival& arrival : arrivals_) bytes += static_cast<double>(arrival.bytes);
  return 8 * bytes / static_cast<double>(kRateSpanUs);
}

std::int64_t AskWindow::round_trip_us() const {
  return quantile(std::vector<std::int64_t>(trips_us_.begin(), trips_us_.end()), 0.5);
}

}  // namespace mirage
