#pragma once
// Asks that wait for a form of a tile, which is made from another form.
// Input:  asks for forms; forms as they are made
// Output: jobs of the encode stage
// Thread: the network loop's
// Full:   refuses more forms, in all or of one session; rendered tiles use the same queue and
//         still pass

#include <cstdint>
#include <map>
#include <vector>

#include "protocol/base/bounded_queue.h"
#include "protocol/codec/tile_codec.h"
#include "server/base/wait_list.h"
#include "server/tile/tile_job.h"

namespace mirage {

class FormRequests {
 public:
  explicit FormRequests(BoundedQueue<EncodeJob>& jobs) : jobs_(jobs) {}

  /// Requests the waiter's form to be made from `lossless`, once for all its waiters. False: too
  /// much is under way.
  bool wait(const TileId& id, const StoredTilePtr& lossless, const Waiter& waiter);
  /// Ends the making of a form and returns its waiters.
  std::vector<Waiter> take_waiting(const TileId& id, TileCodec codec);
  void remove_session(SessionId session);
  bool waiting() const { return waiting_.size() > 0; }
  /// Number of waiting asks of a session.
  std::size_t asks_of(SessionId session) const;

 private:
  WaitList<FormId, Waiter> waiting_;
  std::map<SessionId, std::size_t> asks_;  ///< number of asks of each session in waiting_
  BoundedQueue<EncodeJob>& jobs_;
};

}  // namespace mirage
