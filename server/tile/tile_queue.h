#pragma once
// Tile queue.
// Input:  asks from the sessions (network thread). Output: batches for the render stage.
// Thread: any; one lock. Bounded per session by kMaxQueuedAsksPerClient.
// Full:   the ask is refused as busy. Equal keys merge, worst error first, sessions take turns,
//         cancelled and late asks are dropped unrendered.

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <variant>
#include <vector>

#include "protocol/base/clock.h"
#include "server/base/counters.h"
#include "server/tile/tile_job.h"

namespace mirage {

class TileQueue {
 public:
  TileQueue(const Clock& clock, Counters& counters) : clock_(clock), counters_(counters) {}

  enum class Admission { kQueued, kMerged, kBusy };
  Admission submit(const TileKey& key, const TileId& id, const ObjectLighting& lighting,
                   const Waiter& waiter, const Lighting& world = {});
  /// A full render, between batches of tiles. False: the session waits for one already.
  bool submit(ReferenceJob job);
  /// For how long a new ask of the session would wait here, by what a tile has taken of late, µs:
  /// sessions take turns.
  double wait_us(SessionId session, double tile_us) const;
  /// Views come between tiles: one, then at least one batch of tiles where some wait; those that
  /// nobody wants yet after all tiles.
  void submit(ViewJob job);
  /// Somebody wants it now.
  void want_view(const TileId& id);
  /// Nobody wants it any more. False: it is being drawn already.
  bool drop_view(const TileId& id);
  void cancel(SessionId session, std::uint32_t request_id);
  void remove_session(SessionId session);

  using Work = std::variant<std::vector<TileJob>, ReferenceJob, ViewJob>;
  /// What the render stage takes on.
  struct Room {
    /// Asked for each tile's edge in turn; ends the batch with false.
    std::function<bool(std::uint32_t)> fits;
    /// Tiles from this edge on come alone, as slow work.
    std::uint32_t slow_edge = UINT32_MAX;
    /// Whether it takes slow work now: full renders, views and such tiles.
    std::function<bool()> slow = [] { return true; };
  };
  /// Next work; waits while there is none if `wait`. nullopt: closed, or nothing to do and not
  /// waiting.
  std::optional<Work> take(const Room& room, bool wait);
  /// Whoever asked for the full render that was taken last is still there.
  bool reference_wanted() const;
  /// Whoever waits in take() asks again what there is room for.
  void look_again() { not_empty_.notify_all(); }
  bool closed() const;

  /// Everybody waiting for a finished tile; the key may be queued anew afterwards.
  std::vector<Waiter> finish(const TileId& id);
  /// Asks that were dropped since the last call because their deadline passed.
  std::vector<Waiter> take_late();

  std::size_t length() const;
  /// Asks of a session, tiles and full renders, that wait or are being rendered.
  std::size_t asks_of(SessionId session) const;
  /// Places in the rankings of all sessions: one for each ask that waits to be rendered.
  std::size_t ranks() const;
  void close();

 private:
  struct Entry {
    TileJob job;
    std::vector<Waiter> waiters;
    bool rendering = false;
  };
  // Worst error first; equal errors in order of arrival.
  struct Rank {
    float error_px;
    std::uint64_t order;
    bool operator<(const Rank& o) const {
      return error_px != o.error_px ? error_px > o.error_px : order < o.order;
    }
  };
  struct Request {
    TileId id;
    std::optional<Rank> rank;  ///< while it waits to be rendered
  };
  struct SessionQueue {
    double served = 0;  ///< work done for it, as turns are counted
    std::map<Rank, TileId> ranked;
    std::unordered_map<std::uint32_t, Request> requests;
  };

  void drop_waiter(SessionId session, std::uint32_t request_id, const TileId& id);
  /// Ends requests, their ranks with them.
  void end_request(SessionQueue& session, std::uint32_t request_id);
  void end_requests(const std::vector<Waiter>& waiters);
  /// It is being rendered, and ranked no longer.
  void start(Entry& entry);
  bool drop_late(Entry& entry);
  /// The next to be rendered, of edges below `slow_edge` unless `slow`, still in its place, and
  /// whose turn it is: of those who wait the one for whom least has been done.
  Entry* next_entry(std::uint32_t slow_edge, bool slow, SessionQueue** turn);
  Entry& first_of(const SessionQueue& session);
  std::optional<Work> take_reference();
  std::optional<Work> take_view();
  /// What waits and fits, marked as being rendered.
  std::vector<TileJob> take_batch(const Room& room, bool slow);
  /// The view to draw next: a wanted one, if there is one.
  std::deque<ViewJob>::iterator next_view();

  const Clock& clock_;
  Counters& counters_;
  mutable std::mutex mutex_;
  std::condition_variable not_empty_;
  std::unordered_map<TileId, Entry> entries_;
  std::map<SessionId, SessionQueue> sessions_;
  std::deque<ReferenceJob> references_;
  std::optional<SessionId> reference_for_;  ///< who asked for the one taken last, while there
  std::deque<ViewJob> views_;
  bool view_was_last_ = false, reference_was_last_ = false;
  std::vector<Waiter> late_;
  double served_ = 0;  ///< of the session whose turn it was last
  std::uint64_t order_ = 0;
  bool closed_ = false;
};

}  // namespace mirage
