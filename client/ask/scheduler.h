#pragma once
// Scheduler.
// Input:  needs of this frame, replies as they come. Output: request batches (asks, cancels,
//         credit), in one list by what each is worth for what it takes.
// Thread: the frame loop's.
// Full:   what is in flight is held to the window (ask_window.h) and to what the server completes
//         (server_pace.h); needs beyond it wait.

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "client/ask/ask_window.h"
#include "client/ask/server_pace.h"
#include "client/hold/asset_need.h"
#include "client/plan/tile_need.h"
#include "client/price/tile_bytes.h"
namespace mirage {

class SceneView;
namespace wire {
struct RequestBatchT;
}

/// An ask under way.
struct PendingAsk {
  TileNeed need;
  std::uint32_t object = 0;
  std::int64_t sent_us = 0;
  double expected_bytes = 0;   ///< as counted when it was sent: the expectation changes
  std::int64_t needed_us = 0;  ///< when it was needed last
  bool lossy = false;          ///< asked for in a codec that loses colour
  std::size_t under_way = 0;   ///< asks without a reply when it was sent, itself among them
};

/// Geometry or an image under way.
struct PendingAsset {
  AssetNeed need;
  std::int64_t sent_us = 0;
};

class Scheduler {
 public:
  Scheduler();
  /// Nothing asked so far will be answered (new connection, new scene).
  void reset();
  /// A number for a request of another kind: all share one numbering.
  std::uint32_t next_number() { return next_request_++; }
  /// From now on tiles are asked for in a codec that loses colour, or in one that does not.
  void ask_lossy(bool lossy) { lossy_ = lossy; }

  /// Makes the next batch of what is needed and not yet under way; nullopt when there is nothing
  /// to say. Asks whose instance is no longer needed are cancelled; those for a light that has
  /// changed meanwhile are not, or a light that always changes would never show.
  std::optional<wire::RequestBatchT> plan(const SceneView& scene,
                                          const std::vector<TileNeed>& needs,
                                          const std::vector<AssetNeed>& asset_needs,
                                          std::uint32_t lighting_id, std::int64_t now_us);

  /// The ask under way by this number; nullptr: none, or cancelled.
  const PendingAsk* pending(std::uint32_t request_id) const {
    const auto at = pending_.find(request_id);
    return at != pending_.end() ? &at->second : nullptr;
  }
  /// The ask a reply answers; nullopt when it was cancelled or never made. `server_us`: for which
  /// the server had it.
  std::optional<PendingAsk> finish(std::uint32_t request_id, std::size_t bytes,
                                   std::int64_t server_us, std::int64_t now_us);
  /// A refusal: the instance may ask again after a pause.
  void refuse(std::uint32_t request_id, std::int64_t now_us);
  /// The same for geometry and images.
  std::optional<AssetNeed> finish_asset(std::uint32_t request_id, std::size_t bytes,
                                        std::int64_t now_us);

  void note_frame(std::int64_t now_us) { window_.frame_began(now_us); }
  /// The hello was answered; a tile is said to take the server `tile_us`, 0: unknown.
  void note_welcome(std::int64_t now_us, std::int64_t trip_us, std::int64_t tile_us) {
    window_.welcomed(now_us, trip_us);
    pace_.expect(tile_us);
  }
  /// A part of what comes unasked after it.
  void note_opening(std::size_t bytes, std::int64_t now_us) {
    window_.opening_arrived(now_us, bytes);
  }
  /// What is neither has come and took its time on the link.
  void note_other(std::size_t bytes, std::int64_t now_us) { window_.stray_arrived(now_us, bytes); }

  /// Measured request-to-reply time (median of the last), µs; the rest of the horizon is on top.
  std::int64_t round_trip_us() const { return window_.round_trip_us(); }
  /// Seconds for which asks have been held back by a link that is full without a break.
  double saturated_s(std::int64_t now_us) const {
    return saturated_since_us_ < 0 ? 0 : static_cast<double>(now_us - saturated_since_us_) * 1e-6;
  }
  /// What is in view and shown by nothing of its own was left unasked in the last plan.
  bool first_waits() const { return first_waits_; }
  /// Bytes down in the last second, as Mbit/s.
  double rate_mbps() const { return window_.rate_mbps(); }
  std::size_t in_flight() const { return pending_.size(); }
  /// What tiles weigh in the codec they are asked for in now.
  const TileBytes& tile_bytes() const { return tile_bytes_[lossy_]; }
  std::uint64_t asked() const { return asked_; }
  std::uint64_t cancelled() const { return cancelled_; }

 private:
  /// One ask at a time per instance for a picture, for its shadow and for its object as a caster,
  /// and per phase of a moving one: phases are asked for ahead.
  using Wanted = std::tuple<std::uint32_t, Phase, std::uint8_t>;
  static Wanted wanted(const TileNeed& need) {
    return {need.instance, need.phase, is_picture(need.channels) ? kLitTile : need.channels};
  }
  /// Neither under way nor refused a moment ago.
  bool may_ask(const TileNeed& need, std::int64_t now_us) const;
  bool may_ask(const AssetNeed& need, std::int64_t now_us) const;
  /// Cancels what has not been needed for a while, or will not come any more.
  void give_up(const std::vector<TileNeed>& needs, std::int64_t now_us, wire::RequestBatchT& batch);
  /// Asks for what window and server have room for; true: more is wanted than the window holds.
  bool ask(const SceneView& scene, const std::vector<TileNeed>& needs,
           const std::vector<AssetNeed>& asset_needs, double window, std::int64_t now_us,
           wire::RequestBatchT& batch);
  void ask_tile(const SceneView& scene, const TileNeed& need, double rank, std::int64_t now_us,
                wire::RequestBatchT& batch);
  /// Something to ask for; one of both.
  struct Offer {
    const TileNeed* tile = nullptr;
    const AssetNeed* asset = nullptr;
    double rank = 0;  ///< what it is worth, a byte
  };
  /// All that may be asked for, what is worth most for what it takes first.
  std::vector<Offer> offers(const std::vector<TileNeed>& needs,
                            const std::vector<AssetNeed>& asset_needs, std::int64_t now_us) const;
  /// Counted for a window of so many bytes.
  double under_way(double window) const;
  void ask_asset(const AssetNeed& need, std::int64_t now_us, wire::RequestBatchT& batch);
  /// Takes what is under way off the books.
  std::optional<PendingAsset> end_asset(std::uint32_t request_id);

  std::map<std::uint32_t, PendingAsk> pending_;           ///< by request id
  std::map<Wanted, std::uint32_t> pending_wanted_;        ///< -> request id
  std::map<std::uint32_t, std::int64_t> not_before_us_;   ///< instances that were refused
  std::map<std::uint32_t, PendingAsset> assets_pending_;  ///< by request id
  std::set<AssetId> assets_under_way_;
  /// Cancelled: what was sent before the server heard of it still takes its place on the link.
  struct Leaving {
    std::int64_t sent_us = 0;
    std::int64_t until_us = 0;
    double bytes = 0;
  };
  std::map<std::uint32_t, Leaving> leaving_;              ///< by request id
  std::map<AssetId, std::int64_t> assets_not_before_us_;  ///< refused
  AskWindow window_;
  ServerPace pace_;
  std::int64_t lost_us_;                  ///< an ask this old is given up
  std::int64_t held_since_us_ = -1;       ///< asks wait for the window
  std::int64_t saturated_since_us_ = -1;  ///< and the link is full
  bool first_waits_ = false;
  /// Without loss and with it: a client that goes from one to the other must not expect the other's
  /// sizes, or it asks for more than the link holds.
  std::array<TileBytes, 2> tile_bytes_;
  bool lossy_ = false;
  double in_flight_bytes_ = 0;        ///< of tiles
  double leaving_bytes_ = 0;          ///< of cancelled tiles that may still come
  double asset_bytes_ = 0;            ///< of geometry and images, in flight
  std::uint64_t received_bytes_ = 0;  ///< of tiles, on this connection
  std::uint32_t next_request_ = 1;
  std::uint64_t asked_ = 0;
  std::uint64_t cancelled_ = 0;
};

}  // namespace mirage
