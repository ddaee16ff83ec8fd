#pragma once
// Scheduler.
// Input:  needs of this frame, replies as they come. Output: request batches (asks, cancels,
// credit). Thread: the frame loop's. Full:   what is in flight is held to rate x (RTT + 100 ms);
// needs beyond it wait, worst first.

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "client/core/selector.h"
#include "protocol/message.h"

namespace mirage {

/// An ask under way.
struct PendingAsk {
  TileNeed need;
  std::uint32_t object = 0;
  std::int64_t sent_us = 0;
  std::uint32_t lighting_id = 0;
  double expected_bytes = 0;  ///< as counted when it was sent: the expectation changes
};

class Scheduler {
 public:
  /// Nothing asked so far will be answered (new connection, new scene).
  void reset();

  /// Makes the next batch of what is needed and not yet under way; nullopt when there is nothing
  /// to say. Asks whose instance is no longer needed are cancelled.
  std::optional<wire::RequestBatchT> plan(const SceneView& scene,
                                          const std::vector<TileNeed>& needs,
                                          const std::vector<std::uint32_t>& mesh_needs,
                                          std::uint32_t lighting_id, std::int64_t now_us);

  /// The ask a reply answers; nullopt when it was cancelled or never made.
  std::optional<PendingAsk> finish(std::uint32_t request_id, std::size_t bytes,
                                   std::int64_t now_us);
  /// A refusal: the instance may ask again after a pause.
  void refuse(std::uint32_t request_id, std::int64_t now_us);
  void mesh_arrived(std::uint32_t object) { meshes_pending_.erase(object); }
  void mesh_refused(std::uint32_t object) { meshes_refused_.insert(object); }

  /// Measured request-to-reply time (median of the last), µs; the rest of the horizon is on top.
  std::int64_t round_trip_us() const;
  std::size_t in_flight() const { return pending_.size(); }
  std::uint64_t asked() const { return asked_; }
  std::uint64_t cancelled() const { return cancelled_; }

 private:
  /// One ask at a time per instance, and per phase of a moving one: phases are asked for ahead.
  using Wanted = std::pair<std::uint32_t, Phase>;
  static Wanted wanted(const TileNeed& need) { return {need.instance, need.phase}; }
  double expected_bytes(std::uint8_t size_class) const;
  double window_bytes(std::int64_t now_us) const;

  std::map<std::uint32_t, PendingAsk> pending_;          ///< by request id
  std::map<Wanted, std::uint32_t> pending_wanted_;       ///< -> request id
  std::map<std::uint32_t, std::int64_t> not_before_us_;  ///< instances that were refused
  std::set<std::uint32_t> meshes_pending_;
  std::set<std::uint32_t> meshes_refused_;
  std::deque<std::pair<std::int64_t, std::size_t>> arrivals_;  ///< time and bytes, last second
  std::deque<std::int64_t> round_trips_us_;
  std::int64_t shortest_trip_us_ = 0;
  double bytes_per_texel_ = 0.7;
  double in_flight_bytes_ = 0;
  std::uint64_t received_bytes_ = 0;  ///< of tiles, on this connection
  std::uint32_t next_request_ = 1;
  std::uint64_t asked_ = 0;
  std::uint64_t cancelled_ = 0;
};

}  // namespace mirage
