#pragma once
// Who waits for a form of a tile that is being made from another.
// Input:  asks for forms, forms as they are made. Output: jobs of the encode stage.
// Thread: the network loop's.
// Full:   nothing more is taken on; rendered tiles fill the same queue and go on.

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "protocol/bounded_queue.h"
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

 private:
  /// By tile; of all codecs.
  std::unordered_map<TileId, std::vector<Waiter>> waiting_;
  BoundedQueue<EncodeJob>& jobs_;
  std::size_t count_ = 0;  ///< of all who wait
};

}  // namespace mirage
