#include "client/ask/scheduler.h"

#include <algorithm>
#include <cmath>

#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "protocol/base/order.h"
#include "wire_generated.h"

namespace mirage {
namespace {

constexpr std::int64_t kPatienceUs = 100'000;  // or a trip, if that is longer
constexpr std::int64_t kRefusalPauseUs = 250'000;
constexpr std::int64_t kAssetPauseUs = 5'000'000;
// An ask without an answer is given up after this time, then after twice as long: a link may be
// slow.
constexpr std::int64_t kLostUs = 5'000'000;
constexpr std::int64_t kLostAtMostUs = 120'000'000;
constexpr int kLostTrips = 4;
constexpr double kSpareS = 0.25;               // of an idle link
constexpr std::size_t kMaxAsksPerFrame = 256;  // the rest waits
// The credit is far ahead of the window: the window limits, credit only protects the client's
// memory.
constexpr std::uint64_t kCreditAhead = 64u << 20;

}  // namespace

Scheduler::Scheduler() : lost_us_(kLostUs) {}

void Scheduler::reset() {
  pending_.clear();
  pending_wanted_.clear();
  not_before_us_.clear();
  assets_pending_.clear();
  assets_under_way_.clear();
  assets_not_before_us_.clear();
  window_.reset();
  pace_ = ServerPace();
  work_ = ServerWork();
  leaving_.clear();
  in_flight_bytes_ = leaving_bytes_ = asset_bytes_ = 0;
  received_bytes_ = 0;
  held_since_us_ = saturated_since_us_ = -1;
  first_waits_ = false;
}

std::optional<wire::RequestBatchT> Scheduler::plan(const SceneView& scene,
                                                   const std::vector<TileNeed>& needs,
                                                   const std::vector<AssetNeed>& asset_needs,
                                                   std::uint32_t lighting_id, std::int64_t now_us) {
  wire::RequestBatchT batch;
  batch.lighting_id = lighting_id;
  give_up(needs, now_us, batch);
  const std::int64_t held_back_us =
      held_since_us_ < 0 ? 0 : std::max<std::int64_t>(now_us - held_since_us_, 1);
  const bool idle = pending_.empty() && assets_pending_.empty();
  const double window = window_.update(now_us, held_back_us, idle);
  const bool held_back = ask(scene, offers(needs, asset_needs, now_us), window, now_us, batch);
  const auto waits = [&](const auto& need) { return need.first && may_ask(need, now_us); };
  first_waits_ = std::any_of(needs.begin(), needs.end(), waits) ||
                 std::any_of(asset_needs.begin(), asset_needs.end(), waits);
  if (!held_back) held_since_us_ = -1;
  if (held_back && held_since_us_ < 0) held_since_us_ = now_us;
  // Asks may also wait for a link that is not full, if little came through it lately.
  const bool saturated = held_back && window_.queued();
  if (!saturated) saturated_since_us_ = -1;
  if (saturated && saturated_since_us_ < 0) saturated_since_us_ = now_us;
  if (batch.asks.empty() && batch.cancels.empty() && batch.mesh_asks.empty() &&
      batch.image_asks.empty()) {
    return std::nullopt;
  }
  batch.credit_bytes = received_bytes_ + kCreditAhead;
  return batch;
}

void Scheduler::give_up(const std::vector<TileNeed>& needs, std::int64_t now_us,
                        wire::RequestBatchT& batch) {
  for (auto it = leaving_.begin(); it != leaving_.end();) {
    if (it->second.until_us > now_us) {
      ++it;
      continue;
    }
    leaving_bytes_ = std::max(0.0, leaving_bytes_ - it->second.bytes);
    it = leaving_.erase(it);
  }
  // Needed instances: a phase that has passed returns with the next loop.
  std::set<std::uint32_t> needed;
  for (const TileNeed& need : needs) needed.insert(need.instance);
  bool lost_any = false;
  const std::int64_t patience_us = std::max(kPatienceUs, window_.trip_us(0, 0) + pace_.server_us());
  for (auto it = pending_.begin(); it != pending_.end();) {
    if (batch.cancels.size() >= limits::kMaxCancelsPerBatch) break;
    PendingAsk& ask = it->second;
    if (needed.count(ask.need.instance) != 0) ask.needed_us = now_us;
    // A reply that is under way is cheaper than asking again a frame later.
    const bool useless = now_us - ask.needed_us > patience_us;
    const bool lost = now_us - ask.sent_us > lost_us_;
    lost_any = lost_any || lost;
    if (!useless && !lost) {
      ++it;
      continue;
    }
    batch.cancels.push_back(it->first);
    in_flight_bytes_ -= ask.expected_bytes;
    if (!lost) {
      // Replies that the server sent before it got the cancel arrive within a trip. Half a trip is
      // added, because the way may just have become longer.
      const std::int64_t trip =
          window_.trip_us(ask.expected_bytes, in_flight_bytes_ + leaving_bytes_ + asset_bytes_);
      leaving_[it->first] = {ask.sent_us, now_us + trip + trip / 2, ask.expected_bytes};
      leaving_bytes_ += ask.expected_bytes;
    }
    pending_wanted_.erase(wanted(ask.need));
    it = pending_.erase(it);
    ++cancelled_;
  }
  if (lost_any) lost_us_ = std::min(2 * lost_us_, kLostAtMostUs);
}

double Scheduler::spare_bytes() const {
  if (held_since_us_ >= 0 || first_waits_ || window_.queued()) return 0;
  return std::max(0.0, window_.spare_bytes(kSpareS) - in_flight_bytes_ - asset_bytes_);
}

// A large reply is under way until all of it is here. It counts for at most half of the window, or
// the link would run dry before that.
double Scheduler::under_way(double window) const {
  double bytes = in_flight_bytes_ + leaving_bytes_;
  for (const auto& [id, asset] : assets_pending_) {
    bytes += std::min(asset.need.expected_bytes, 0.5 * window);
  }
  return bytes;
}

std::vector<Scheduler::Offer> Scheduler::offers(const std::vector<TileNeed>& needs,
                                                const std::vector<AssetNeed>& asset_needs,
                                                std::int64_t now_us) const {
  std::vector<Offer> out;
  // A server at its limit has a price as well: the bytes that arrive while it makes a tile.
  const double bytes_a_us = pace_.at_limit() ? window_.rate_mbps() / 8 : 0;
  for (const TileNeed& need : needs) {
    if (!may_ask(need, now_us)) continue;
    const double bytes = tile_bytes_[lossy_].expected(need.size_class, need.channels);
    out.push_back(
        {&need, nullptr, need.gain / (bytes + bytes_a_us * work_.expected_us(need.size_class))});
  }
  for (const AssetNeed& need : asset_needs) {
    if (may_ask(need, now_us)) out.push_back({nullptr, &need, need.gain / need.expected_bytes});
  }
  sort_descending(out, [](const Offer& offer) { return offer.rank; });
  return out;
}

bool Scheduler::ask(const SceneView& scene, const std::vector<Offer>& offers, double window,
                    std::int64_t now_us, wire::RequestBatchT& batch) {
  const std::size_t most = pace_.limit(window_.way_us(), 2 * window_.slack_us());
  bool held_back = false;
  for (const Offer& offer : offers) {
    // Another phase or instance of the same object may have been asked for by now.
    if (offer.tile ? !may_ask(*offer.tile, now_us) : !may_ask(*offer.asset, now_us)) continue;
    const bool room =
        offer.tile ? batch.asks.size() < kMaxAsksPerFrame && pending_.size() < most
                   : batch.mesh_asks.size() + batch.image_asks.size() < limits::kMaxAsksPerBatch;
    if (!room) continue;
    const bool full = under_way(window) >= window;
    held_back = held_back || full;
    if (full) continue;
    if (offer.tile) {
      ask_tile(scene, *offer.tile, offer.rank, now_us, batch);
    } else {
      ask_asset(*offer.asset, now_us, batch);
    }
  }
  return held_back;
}

bool Scheduler::may_ask(const TileNeed& need, std::int64_t now_us) const {
  const auto pause = not_before_us_.find(need.instance);
  const bool paused = pause != not_before_us_.end() && pause->second > now_us;
  return !paused && pending_wanted_.count(wanted(need)) == 0;
}

bool Scheduler::may_ask(const AssetNeed& need, std::int64_t now_us) const {
  const auto pause = assets_not_before_us_.find(need.id);
  const bool paused = pause != assets_not_before_us_.end() && pause->second > now_us;
  return !paused && assets_under_way_.count(need.id) == 0;
}

void Scheduler::ask_tile(const SceneView& scene, const TileNeed& need, double rank,
                         std::int64_t now_us, wire::RequestBatchT& batch) {
  const std::uint32_t id = next_request_++;
  const InstanceView& view = scene.instances[need.instance];
  batch.asks.emplace_back(id, view.id, scene.object_id(need.instance), static_cast<float>(rank), 0u,
                          need.distance.index, need.cell.x, need.cell.y, need.cell.level,
                          need.distance.level, need.size_class, need.channels, need.phase);
  const double bytes = tile_bytes_[lossy_].expected(need.size_class, need.channels);
  in_flight_bytes_ += bytes;
  pending_[id] = {need, view.object, now_us, bytes, now_us, lossy_, pending_.size() + 1};
  pending_wanted_[wanted(need)] = id;
  ++asked_;
}

void Scheduler::ask_asset(const AssetNeed& need, std::int64_t now_us, wire::RequestBatchT& batch) {
  const std::uint32_t id = next_request_++;
  if (need.id.kind == AssetId::Kind::kMesh) {
    batch.mesh_asks.emplace_back(id, need.id.index, need.id.level);
  } else {
    batch.image_asks.emplace_back(id, need.id.index, need.id.level);
  }
  assets_pending_[id] = {need, now_us};
  assets_under_way_.insert(need.id);
  asset_bytes_ += need.expected_bytes;
}

std::optional<PendingAsset> Scheduler::end_asset(std::uint32_t request_id) {
  const auto at = assets_pending_.find(request_id);
  if (at == assets_pending_.end()) return std::nullopt;
  const PendingAsset asset = at->second;
  assets_pending_.erase(at);
  assets_under_way_.erase(asset.need.id);
  asset_bytes_ = std::max(0.0, asset_bytes_ - asset.need.expected_bytes);
  return asset;
}

std::optional<AssetNeed> Scheduler::finish_asset(std::uint32_t request_id, std::size_t bytes,
                                                 std::int64_t now_us) {
  const std::optional<PendingAsset> asset = end_asset(request_id);
  if (!asset) return std::nullopt;
  window_.asset_arrived(asset->sent_us, now_us, bytes, asset->need.expected_bytes);
  return asset->need;
}

std::optional<PendingAsk> Scheduler::finish(std::uint32_t request_id, std::size_t bytes,
                                            const ServerTimes& server, std::int64_t now_us) {
  received_bytes_ += bytes;
  const auto at = pending_.find(request_id);
  if (at == pending_.end()) {  // cancelled, but sent nevertheless
    const auto left = leaving_.find(request_id);
    if (left == leaving_.end()) {
      window_.stray_arrived(now_us, bytes);
      return std::nullopt;
    }
    window_.asset_arrived(left->second.sent_us, now_us, bytes, left->second.bytes);
    leaving_bytes_ = std::max(0.0, leaving_bytes_ - left->second.bytes);
    leaving_.erase(left);
    return std::nullopt;
  }
  const PendingAsk ask = at->second;
  pending_.erase(at);
  pending_wanted_.erase(wanted(ask.need));
  in_flight_bytes_ = std::max(0.0, in_flight_bytes_ - ask.expected_bytes);
  tile_bytes_[ask.lossy].arrived(ask.need.size_class, ask.need.channels, bytes);
  // This machine was suspended if the reply took longer than asks are kept, so it tells no trip.
  const std::int64_t trip = now_us - ask.sent_us;
  if (trip > lost_us_) {
    window_.asset_arrived(now_us, now_us, bytes, ask.expected_bytes);
    return ask;
  }
  const TileTrip tile{ask.sent_us, now_us, server.had_us, bytes, ask.expected_bytes, ask.under_way};
  work_.arrived(ask.need.size_class, server.worked_us);
  pace_.tile_arrived(tile);
  window_.tile_arrived(tile);
  lost_us_ = std::clamp(kLostTrips * trip, kLostUs, kLostAtMostUs);
  return ask;
}

void Scheduler::refuse(std::uint32_t request_id, std::int64_t now_us) {
  if (const std::optional<PendingAsset> asset = end_asset(request_id)) {
    assets_not_before_us_[asset->need.id] = now_us + kAssetPauseUs;
    return;
  }
  const auto at = pending_.find(request_id);
  if (at == pending_.end()) return;
  not_before_us_[at->second.need.instance] = now_us + kRefusalPauseUs;
  pending_wanted_.erase(wanted(at->second.need));
  in_flight_bytes_ = std::max(0.0, in_flight_bytes_ - at->second.expected_bytes);
  pending_.erase(at);
}

}  // namespace mirage
