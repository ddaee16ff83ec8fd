#pragma once
// Scheduler: sends what is needed, largest gain per byte first, as far as link and server have
// room.
// Input:  needs of this frame, replies as they arrive.
// Output: request batches (asks, cancels, credit), from one list, largest gain per byte first.
// Thread: the frame loop's.
// Full:   asks in flight are limited to the window (ask_window.h), and to what the server completes
//         (server_pace.h); further needs wait.

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
#include "client/price/server_work.h"
#include "client/price/tile_bytes.h"
namespace mirage {

class SceneView;
namespace wire {
struct RequestBatchT;
}

/// Times that a reply tells, us.
struct ServerTimes {
  std::int64_t had_us = 0;     ///< for which the server had the ask
  std::int64_t worked_us = 0;  ///< for which it rendered and encoded the tile
};

/// An ask for a tile that is under way.
struct PendingAsk {
  TileNeed need;
  std::uint32_t object = 0;
  std::int64_t sent_us = 0;
  double expected_bytes = 0;   ///< expectation when it was sent; that changes later
  std::int64_t needed_us = 0;  ///< when it was last needed
  bool lossy = false;          ///< asked for in a codec that loses colour
  std::size_t under_way = 0;   ///< unanswered asks when it was sent, including itself
};

/// An ask for geometry or an image that is under way.
struct PendingAsset {
  AssetNeed need;
  std::int64_t sent_us = 0;
};

class Scheduler {
 public:
  Scheduler();
  /// Forgets all asks, because none will be answered (new connection, new scene).
  void reset();
  /// Returns a number for a request of another kind. All requests share one numbering.
  std::uint32_t next_number() { return next_request_++; }
  /// Sets whether tiles are asked for in a codec that loses colour.
  void ask_lossy(bool lossy) { lossy_ = lossy; }

  /// Returns the next batch of what is needed and not yet under way; nullopt if there is nothing to
  /// say. Asks whose instance is no longer needed are cancelled. Asks for a former light are not;
  /// otherwise a light that keeps changing would never show.
  std::optional<wire::RequestBatchT> plan(const SceneView& scene,
                                          const std::vector<TileNeed>& needs,
                                          const std::vector<AssetNeed>& asset_needs,
                                          std::uint32_t lighting_id, std::int64_t now_us);

  /// Returns the ask under way with this number; nullptr: none, or cancelled.
  const PendingAsk* pending(std::uint32_t request_id) const {
    const auto at = pending_.find(request_id);
    return at != pending_.end() ? &at->second : nullptr;
  }
  /// Returns the ask that a reply answers; nullopt if it was cancelled or never sent.
  std::optional<PendingAsk> finish(std::uint32_t request_id, std::size_t bytes,
                                   const ServerTimes& server, std::int64_t now_us);
  /// Notes a refusal: its instance may ask again after a pause.
  void refuse(std::uint32_t request_id, std::int64_t now_us);
  /// Returns the need that a reply with geometry or an image answers; nullopt as for finish().
  std::optional<AssetNeed> finish_asset(std::uint32_t request_id, std::size_t bytes,
                                        std::int64_t now_us);

  void note_frame(std::int64_t now_us) { window_.frame_began(now_us); }
  /// Notes the reply to the hello. A tile is said to take the server `tile_us`; 0: unknown.
  void note_welcome(std::int64_t now_us, std::int64_t trip_us, std::int64_t tile_us) {
    window_.welcomed(now_us, trip_us);
    pace_.expect(tile_us);
  }
  /// Notes a part of the opening, which comes unasked after the welcome.
  void note_opening(std::size_t bytes, std::int64_t now_us) {
    window_.opening_arrived(now_us, bytes);
  }
  /// Notes a reply that is neither a tile nor part of the opening; it used the link.
  void note_other(std::size_t bytes, std::int64_t now_us) { window_.stray_arrived(now_us, bytes); }

  /// Returns the time from request to reply, µs: the median of the last ones. Callers add the rest
  /// of the horizon to it.
  std::int64_t round_trip_us() const { return window_.round_trip_us(); }
  /// Returns the seconds for which a full link has held back asks without a break.
  double saturated_s(std::int64_t now_us) const {
    return saturated_since_us_ < 0 ? 0 : static_cast<double>(now_us - saturated_since_us_) * 1e-6;
  }
  /// Returns the bytes that the link would bring in a moment beside what is under way; 0: asks wait
  /// for it.
  double spare_bytes() const;
  /// True if the last plan left unasked a first image of something in view.
  bool first_waits() const { return first_waits_; }
  /// Returns the bytes received in the last second, as Mbit/s.
  double rate_mbps() const { return window_.rate_mbps(); }
  std::size_t in_flight() const { return pending_.size(); }
  /// Returns the expected bytes of tiles in the codec that they are asked for in now.
  const TileBytes& tile_bytes() const { return tile_bytes_[lossy_]; }
  std::uint64_t asked() const { return asked_; }
  std::uint64_t cancelled() const { return cancelled_; }

 private:
  /// Only one ask per key may be under way. An instance has a key for its picture, one for its
  /// shadow and one for its object as a caster. Each phase of a moving instance has keys of its
  /// own, because phases are asked for ahead.
  using Wanted = std::tuple<std::uint32_t, Phase, std::uint8_t>;
  static Wanted wanted(const TileNeed& need) {
    return {need.instance, need.phase, is_picture(need.channels) ? kLitTile : need.channels};
  }
  /// True if it is neither under way nor was refused a moment ago.
  bool may_ask(const TileNeed& need, std::int64_t now_us) const;
  bool may_ask(const AssetNeed& need, std::int64_t now_us) const;
  /// Cancels asks that were not needed for a while, and gives up asks that will not be answered.
  void give_up(const std::vector<TileNeed>& needs, std::int64_t now_us, wire::RequestBatchT& batch);
  /// Something to ask for: a tile or an asset.
  struct Offer {
    const TileNeed* tile = nullptr;
    const AssetNeed* asset = nullptr;
    double rank = 0;  ///< gain per byte
  };
  /// Asks for what window and server have room for, in the order of the offers. Returns true if
  /// more is wanted than the window holds.
  bool ask(const SceneView& scene, const std::vector<Offer>& offers, double window,
           std::int64_t now_us, wire::RequestBatchT& batch);
  void ask_tile(const SceneView& scene, const TileNeed& need, double rank, std::int64_t now_us,
                wire::RequestBatchT& batch);
  /// Returns everything that may be asked for, largest gain per byte first.
  std::vector<Offer> offers(const std::vector<TileNeed>& needs,
                            const std::vector<AssetNeed>& asset_needs, std::int64_t now_us) const;
  /// Returns the bytes under way, as they count for a window of `window` bytes.
  double under_way(double window) const;
  void ask_asset(const AssetNeed& need, std::int64_t now_us, wire::RequestBatchT& batch);
  /// Removes an asset from what is under way.
  std::optional<PendingAsset> end_asset(std::uint32_t request_id);

  std::map<std::uint32_t, PendingAsk> pending_;           ///< by request id
  std::map<Wanted, std::uint32_t> pending_wanted_;        ///< to the request id
  std::map<std::uint32_t, std::int64_t> not_before_us_;   ///< instances that were refused
  std::map<std::uint32_t, PendingAsset> assets_pending_;  ///< by request id
  std::set<AssetId> assets_under_way_;
  /// A cancelled ask. A reply sent before the server got the cancel still takes its place on the
  /// link.
  struct Leaving {
    std::int64_t sent_us = 0;
    std::int64_t until_us = 0;
    double bytes = 0;
  };
  std::map<std::uint32_t, Leaving> leaving_;              ///< by request id
  std::map<AssetId, std::int64_t> assets_not_before_us_;  ///< assets that were refused
  AskWindow window_;
  ServerPace pace_;
  ServerWork work_;
  std::int64_t lost_us_;                  ///< age at which an ask is given up
  std::int64_t held_since_us_ = -1;       ///< since when asks wait for the window; -1: none wait
  std::int64_t saturated_since_us_ = -1;  ///< since when the link is also full; -1: it is not
  bool first_waits_ = false;
  /// Expected bytes without loss and with it. A client that changes the codec must not expect the
  /// sizes of the other, or it asks for more than the link holds.
  std::array<TileBytes, 2> tile_bytes_;
  bool lossy_ = false;
  double in_flight_bytes_ = 0;        ///< bytes of tiles
  double leaving_bytes_ = 0;          ///< bytes of cancelled tiles that may still arrive
  double asset_bytes_ = 0;            ///< bytes of geometry and images
  std::uint64_t received_bytes_ = 0;  ///< bytes of tiles on this connection
  std::uint32_t next_request_ = 1;
  std::uint64_t asked_ = 0;
  std::uint64_t cancelled_ = 0;
};

}  // namespace mirage
