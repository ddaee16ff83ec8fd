#pragma once
// Tile queue.
// Input:  asks from the sessions (network thread)
// Output: batches for the render stage
// Thread: any; one lock
// Full:   a session holds kMaxQueuedAsksPerClient asks at most, more are refused as busy
//
// Equal keys merge, the worst error comes first, and sessions take turns. Cancelled and late asks
// are dropped unrendered.

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
  /// Adds a full render, drawn between batches of tiles; an idle one, when nothing else waits.
  /// False: the session waits for one already.
  bool submit(ReferenceJob job);
  /// Returns the expected wait of a new ask of the session, µs, from the recent time `tile_us` of a
  /// tile. Sessions take turns.
  double wait_us(SessionId session, double tile_us) const;
  /// Adds a view. After a view, at least one batch of waiting tiles is drawn before the next view.
  /// Views without a request come after all tiles.
  void submit(ViewJob job);
  /// Marks a view as requested.
  void want_view(const TileId& id);
  /// Drops a view without a request; false: it is being drawn already.
  bool drop_view(const TileId& id);
  void cancel(SessionId session, std::uint32_t request_id);
  void remove_session(SessionId session);

  /// Holds tiles and views back, except views from whole meshes, until levels_made().
  void wait_for_levels();
  /// Gives UploadLevels out as the next work, and after it what was held back.
  void levels_made();
  bool waits_for_levels() const;

  /// Work before the first tile of a scene: its levels of detail go to the graphics card.
  struct UploadLevels {};
  using Work = std::variant<std::vector<TileJob>, ReferenceJob, ViewJob, UploadLevels>;
  /// The work that the render stage accepts.
  struct Room {
    /// Called with the edge of each tile in turn; false ends the batch.
    std::function<bool(std::uint32_t)> fits;
    /// Tiles from this edge on, texels, come alone, as slow work.
    std::uint32_t slow_edge = UINT32_MAX;
    /// True if slow work is accepted now: full renders, views and large tiles.
    std::function<bool()> slow = [] { return true; };
    bool idle = true;  ///< false: an idle full render is under way
  };
  /// Returns the next work; if `wait`, waits for some. nullopt: closed, or nothing to do.
  std::optional<Work> take(const Room& room, bool wait);
  /// True if the session that asked for the full render taken last is still there.
  bool reference_wanted() const;
  /// Makes a thread that waits in take() check the room again. Call it without any lock that the
  /// room takes.
  void look_again();
  bool closed() const;

  /// Ends a finished tile and returns its waiters; the key may be queued again afterwards.
  std::vector<Waiter> finish(const TileId& id);
  /// Returns the asks that were dropped for their deadline since the last call.
  std::vector<Waiter> take_late();

  std::size_t length() const;
  /// Number of a session's asks, tiles and full renders, that wait or are being rendered.
  std::size_t asks_of(SessionId session) const;
  /// Number of ranked asks of all sessions: one for each ask that waits to be rendered.
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
    double served = 0;  ///< work done for it, for counting turns
    std::map<Rank, TileId> ranked;
    std::unordered_map<std::uint32_t, Request> requests;
  };

  void drop_waiter(SessionId session, std::uint32_t request_id, const TileId& id);
  /// Ends requests and removes their ranks.
  void end_request(SessionQueue& session, std::uint32_t request_id);
  void end_requests(const std::vector<Waiter>& waiters);
  /// Marks an entry as being rendered and removes its ranks.
  void start(Entry& entry);
  bool drop_late(Entry& entry);
  /// Returns the next entry to render, left in its place, and the session whose turn it is: the
  /// waiting session with the least work done for it. Without `slow`, edges of `slow_edge` and
  /// above are skipped.
  Entry* next_entry(std::uint32_t slow_edge, bool slow, SessionQueue** turn);
  Entry& first_of(const SessionQueue& session);
  /// Takes the first full render that is idle, or that is not.
  std::optional<Work> take_reference(bool idle);
  std::optional<Work> take_view();
  /// Takes the waiting tiles that fit, and marks them as being rendered.
  std::vector<TileJob> take_batch(const Room& room, bool slow);
  /// Returns the view to draw next; requested views come first. End: none may be drawn now.
  std::deque<ViewJob>::iterator next_view();

  const Clock& clock_;
  Counters& counters_;
  mutable std::mutex mutex_;
  std::condition_variable not_empty_;
  std::unordered_map<TileId, Entry> entries_;
  std::map<SessionId, SessionQueue> sessions_;
  std::deque<ReferenceJob> references_;
  /// session of the full render taken last, while it exists
  std::optional<SessionId> reference_for_;
  std::deque<ViewJob> views_;
  bool view_was_last_ = false, reference_was_last_ = false;
  bool waits_for_levels_ = false, upload_levels_ = false;
  std::vector<Waiter> late_;
  double served_ = 0;  ///< work of the session whose turn was last
  std::uint64_t order_ = 0;
  bool closed_ = false;
};

}  // namespace mirage
