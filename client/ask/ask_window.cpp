#include "client/ask/ask_window.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "protocol/base/quantile.h"

namespace mirage {
namespace {

constexpr double kInitialBytes = 256 * 1024;  // used if the opening told no rate
constexpr double kLeastInitialBytes = 64 * 1024;
constexpr double kMostInitialBytes = 2 << 20;  // upper limit of the first window
constexpr double kLeastBytes = 16 * 1024;
// Least slack; a tile's own time on the link counts as another 25 ms.
constexpr std::int64_t kSlackUs = 25'000;
constexpr std::int64_t kMostSlackUs = 500'000;
constexpr std::size_t kFrames = 8;         // last frames; the shortest sets the slack
constexpr std::int64_t kQueueUs = 12'500;  // a trip longer than the shortest by less shows no queue
constexpr std::int64_t kSecondUs = 1'000'000;
constexpr std::int64_t kShortestSpanUs = 200'000;
constexpr int kSpanTrips = 4;  // trips that a rate is measured over, or fewer within a second
constexpr std::size_t kLeastArrivals = 4;
constexpr std::size_t kFirstArrivals = 8;  // fewer tell nothing
constexpr std::size_t kTrips = 33;
// Trips that have waited in a queue if all of them are long.
constexpr int kQueueTrips = 8;
// Most long trips among them on a link that is not full.
constexpr int kClearTrips = 2;
// Slow replies for a longer time are no burst but a queue.
constexpr std::int64_t kLongestBurstUs = 100'000;
constexpr std::int64_t kPeriodUs = 5'000'000;
constexpr int kPeriodTrips = 20;
constexpr int kDrainTrips = 3;
constexpr int kFarSlacks = 2;  // the window allows a longer queue only for a moment
constexpr int kFarTrips = 2;   // that moment in trips, at least a second
constexpr double kLargestGain = 2;
constexpr double kCertainShare = 0.95;    // of the rate: the bytes of tiles are known to a few %
constexpr double kShortestBusyUs = 1000;  // a shorter busy time tells no rate

}  // namespace

void AskWindow::reset() {
  AskWindow fresh;
  fresh.trips_us_ = std::move(trips_us_);  // the best guess there is
  *this = std::move(fresh);
}

void AskWindow::arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes,
                        double expected) {
  // A large reply arrives at once, but its bytes took time on the link. They began when the former
  // reply arrived or, after a gap, when the tile of the shortest trip would have arrived.
  const Trip shortest = shortest_trip();
  const std::int64_t before = arrivals_.empty() ? INT64_MIN : arrivals_.back().at_us;
  const std::int64_t alone = std::min(sent_us + shortest.us, now_us);
  const double timed = alone > before ? std::max(expected - shortest.bytes, 0.0) : expected;
  const std::int64_t since = std::max(alone, before);
  began_us_ = std::min(began_us_, since);
  arrivals_.push_back({since, now_us, bytes, expected, timed});
}

void AskWindow::frame_began(std::int64_t now_us) {
  if (frame_us_ >= 0) frames_us_.push_back(std::max<std::int64_t>(now_us - frame_us_, 0));
  if (frames_us_.size() > kFrames) frames_us_.pop_front();
  frame_us_ = now_us;
}

void AskWindow::welcomed(std::int64_t now_us, std::int64_t trip_us) {
  opening_us_ = now_us;
  if (shortest_trip().us == 0 && trip_us > 0) shortest_[0] = {trip_us, 0};
}

void AskWindow::tile_arrived(const TileTrip& tile) {
  const std::int64_t now_us = tile.came_us;
  trips_us_.push_back(std::max<std::int64_t>(now_us - tile.sent_us, 0));
  if (trips_us_.size() > kTrips) trips_us_.pop_front();
  // The server's time is taken off the trip, because waiting at the server tells nothing of the
  // link.
  const std::int64_t sent_us =
      tile.sent_us + std::clamp<std::int64_t>(tile.server_us, 0, trips_us_.back());
  server_us_.push_back(trips_us_.back() - (now_us - sent_us));
  if (server_us_.size() > kQueueTrips) server_us_.pop_front();
  const Trip trip{std::max<std::int64_t>(now_us - sent_us, 0), tile.expected};
  if (sent_us >= drained_us_) {
    shortest_ = {Trip{}, longer(trip, shortest_trip()) ? trip : shortest_trip()};
    drained_us_ = INT64_MAX;
  }
  if (trip.us < shortest_[0].us) shortest_[0] = trip;
  const bool slow = longer(trip, shortest_trip());
  long_.push_back(slow);
  if (long_.size() > kQueueTrips) long_.pop_front();
  if (!slow) {
    slow_trips_ = 0;
  } else if (slow_trips_++ == 0) {
    slow_since_us_ = now_us;
  }
  slow_until_us_ = now_us;
  const bool far = trip.us - own_us(trip) > shortest_trip().us + kFarSlacks * slack_us();
  if (!far || far_.us == INT64_MAX) far_since_us_ = now_us;
  far_ = far ? Trip{std::min(trip.us, far_.us), 0} : Trip{};
  arrived(sent_us, now_us, tile.bytes, tile.expected);
}

void AskWindow::asset_arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes,
                              double expected) {
  arrived(sent_us, now_us, bytes, expected);
}

void AskWindow::opening_arrived(std::int64_t now_us, std::size_t bytes) {
  const auto counted = static_cast<double>(bytes);
  const std::int64_t since = opening_us_ < 0 ? now_us : std::min(opening_us_, now_us);
  arrivals_.push_back({since, now_us, bytes, 0, opening_us_ < 0 ? 0 : counted});
  opening_us_ = now_us;
}

void AskWindow::stray_arrived(std::int64_t now_us, std::size_t bytes) {
  arrivals_.push_back({now_us, now_us, bytes, 0, 0});
}

AskWindow::Trip AskWindow::shortest_trip() const {
  const Trip& shortest = shortest_[1].us < shortest_[0].us ? shortest_[1] : shortest_[0];
  return shortest.us == INT64_MAX ? Trip{0, 0} : shortest;
}

std::int64_t AskWindow::own_us(const Trip& trip) const {
  return rate_ > 0 ? std::llround(trip.bytes / rate_) : 0;
}

bool AskWindow::longer(const Trip& trip, const Trip& than) const {
  return trip.us - own_us(trip) > than.us + kQueueUs;
}

std::int64_t AskWindow::usual_trip_us() const { return shortest_trip().us + slack_us(); }

std::int64_t AskWindow::slack_us() const {
  if (frames_us_.empty()) return kSlackUs;
  const std::int64_t shortest = *std::min_element(frames_us_.begin(), frames_us_.end());
  return std::clamp(shortest + shortest / 4, kSlackUs, kMostSlackUs);
}

std::int64_t AskWindow::trip_us(double bytes, double under_way) const {
  if (rate_ <= 0) return usual_trip_us();
  const auto way = static_cast<double>(shortest_trip().us);
  return usual_trip_us() + std::llround(std::max(bytes / rate_, under_way / rate_ - way));
}

double AskWindow::spare_bytes(double seconds) const {
  double rate = window_ / static_cast<double>(usual_trip_us());
  if (std::isfinite(rate_) && rate_ > 0) rate = std::min(rate, rate_);
  return 1e6 * seconds * rate;
}

bool AskWindow::clear() const {
  return long_.size() == kQueueTrips && std::count(long_.begin(), long_.end(), true) <= kClearTrips;
}

bool AskWindow::queued() const {
  if (slow_trips_ < kQueueTrips) return false;
  const std::int64_t long_enough = std::min(usual_trip_us(), kLongestBurstUs);
  return slow_until_us_ - slow_since_us_ >= long_enough;
}

std::int64_t AskWindow::span_us() const {
  const std::int64_t trip = usual_trip_us();
  return std::clamp(kSpanTrips * trip, kShortestSpanUs, std::max(trip, kSecondUs));
}

double AskWindow::busy_rate(std::int64_t now_us) const {
  double received = 0, busy_us = 0;
  std::size_t count = 0;
  for (auto at = arrivals_.rbegin(); at != arrivals_.rend(); ++at, ++count) {
    if (count >= kLeastArrivals && at->at_us < now_us - span_us()) break;
    received += at->timed;
    busy_us += static_cast<double>(at->at_us - at->since_us);
  }
  if (busy_us < kShortestBusyUs) return std::numeric_limits<double>::infinity();
  return received / busy_us;
}

double AskWindow::initial_bytes(std::int64_t now_us) const {
  const double rate = busy_rate(now_us);
  if (opening_us_ < 0 || !std::isfinite(rate)) return kInitialBytes;
  const auto moment = static_cast<double>(usual_trip_us());
  return std::clamp(rate * moment, kLeastInitialBytes, kMostInitialBytes);
}

double AskWindow::whole_rate(std::int64_t now_us) const {
  double received = 0;
  std::int64_t since = now_us - std::clamp(now_us - began_us_, usual_trip_us(), span_us());
  for (auto at = arrivals_.rbegin(); at != arrivals_.rend(); ++at) {
    if (at->at_us < now_us - span_us()) break;
    received += at->expected;
    since = std::min(since, at->since_us);
  }
  return received / static_cast<double>(now_us - since);
}

// Lets everything arrive. Either there was a queue all the time, or the way has become longer; the
// first trip after it shows which.
void AskWindow::drain(std::int64_t now_us, const Trip& shortest) {
  drain_until_us_ = now_us + kDrainTrips * (shortest.us + kSlackUs);
  far_ = {};
}

void AskWindow::turn_period(std::int64_t now_us) {
  if (far_.us != INT64_MAX && drain_until_us_ == 0 &&
      now_us - far_since_us_ >= std::max(kSecondUs, kFarTrips * far_.us)) {
    drain(now_us, far_);
  }
  if (period_ends_us_ != 0 && now_us < period_ends_us_) return;
  if (shortest_[0].us != INT64_MAX && shortest_[1].us != INT64_MAX &&
      longer(shortest_[0], shortest_[1])) {
    drain(now_us, shortest_[0]);
  }
  shortest_ = {Trip{}, shortest_[1].us < shortest_[0].us ? shortest_[1] : shortest_[0]};
  best_rates_ = {0, best_rates_[0]};
  period_ends_us_ = now_us + std::max(kPeriodUs, kPeriodTrips * shortest_trip().us);
}

double AskWindow::update(std::int64_t now_us, std::int64_t held_back_us, bool idle) {
  while (!arrivals_.empty() && arrivals_.front().at_us < now_us - std::max(span_us(), kSecondUs)) {
    arrivals_.pop_front();
  }
  updated_us_ = now_us;
  turn_period(now_us);
  if (drain_until_us_ != 0) {
    if (!idle && now_us < drain_until_us_) return 0;
    drain_until_us_ = 0;
    drained_us_ = now_us;
    best_rates_ = {};
  }
  // If little arrived because little was asked for, that says nothing about the link.
  if (window_ == 0) window_ = initial_ = initial_bytes(now_us);
  const bool unknown = std::min(arrivals_.size(), trips_us_.size()) < kFirstArrivals;
  if (unknown && (idle || held_back_us < kSecondUs)) return window_ = std::min(window_, initial_);
  best_rates_[0] = std::max(best_rates_[0], whole_rate(now_us));
  rate_ = busy_rate(now_us);
  if (held_back_us == 0 && !queued()) return window_ + at_server(now_us);
  const auto trip = static_cast<double>(usual_trip_us());
  const double best = std::max(best_rates_[0], best_rates_[1]);
  const double grown = std::max(window_, kLargestGain * best * trip);
  // The shortest trip includes the time of its own tile on the link, so its bytes are subtracted.
  double wanted = kCertainShare * rate_ * trip - shortest_trip().bytes;
  // Without a queue, more may be under way than has arrived; otherwise the window could never grow.
  if (!queued()) wanted = std::max(wanted, whole_rate(now_us) * trip);
  // If most replies arrive without waiting, the link is not full, however little came through it.
  if (clear()) wanted = std::max(wanted, window_);
  window_ = std::max(kLeastBytes, std::min(wanted, grown));
  return window_ + at_server(now_us);
}

double AskWindow::at_server(std::int64_t now_us) const {
  const auto median =
      quantile(std::vector<std::int64_t>(server_us_.begin(), server_us_.end()), 0.5);
  return whole_rate(now_us) * static_cast<double>(std::max<std::int64_t>(median - kSlackUs, 0));
}

double AskWindow::rate_mbps() const {
  double bytes = 0;
  for (const Arrival& arrival : arrivals_) {
    if (arrival.at_us >= updated_us_ - kSecondUs) bytes += static_cast<double>(arrival.bytes);
  }
  return 8 * bytes / static_cast<double>(kSecondUs);
}

std::int64_t AskWindow::round_trip_us() const {
  if (trips_us_.empty()) return way_us();
  return quantile(std::vector<std::int64_t>(trips_us_.begin(), trips_us_.end()), 0.5);
}

}  // namespace mirage
