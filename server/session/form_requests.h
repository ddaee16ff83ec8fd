#pragma once
// Who waits for a form of a tile that is being made from another.
// Input:  asks for forms, forms as they are made. Output: jobs of the encode stage.
// Thread: the network loop's.
// Full:   nothing more is taken on, in all or of a session; rendered tiles fill the same queue and
//         go on.

#include <cstdint>
#include <map>
#include <vector>

#include "protocol/base/bounded_queue.h"
#include "server/base/wait_list.h"
#include "server/tile/tile_job.h"

namespace mirage {

class FormRequests {
 public:
  explicit FormRequests(BoundedQueue<EncodeJob>& jobs) : jobs_(jobs) {}

  /// Has the waiter's form made of `lossless`, once for all who wait for it. False: there is
  /// enough to do.
  bool wait(const TileId& id, const StoredTilePtr& lossless, const Waiter& waiter);
  /// Who waited for a form that is now made; they wait no longer.
  std::vector<Waiter> take_waiting(const TileId& id, TileCodec codec);
  void remove_session(SessionId session);
  bool waiting() const { return waiting_.size() > 0; }
  /// Asks of a session that wait.
  std::size_t asks_of(SessionId session) const;

 private:
  WaitList<FormId, Waiter> waiting_;
  std::map<SessionId, std::size_t> asks_;  ///< of each session, in waiting_
  BoundedQueue<EncodeJob>& jobs_;
};

}  // namespace mirage
