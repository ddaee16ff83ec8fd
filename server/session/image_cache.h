#pragma once
// Images as they are sent: who waits for a level that is being encoded, and the encoded ones.
// Input:  asks for levels, encoded levels. Output: jobs of the image stage.
// Thread: the network loop's.
// Full:   what was encoded longest ago goes first.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "protocol/base/bounded_queue.h"
#include "server/base/byte_budget.h"
#include "server/base/wait_list.h"
#include "server/tile/tile_job.h"

namespace mirage {

class ImageCache {
 public:
  /// A session and its request.
  using Waiting = std::pair<SessionId, std::uint32_t>;

  explicit ImageCache(BoundedQueue<ImageLevel>& jobs) : jobs_(jobs) {}

  /// An encoded level, empty if it could not be; nullptr: not here.
  const Bytes* find(const ImageLevel& level) const;
  /// Has the level encoded, once for all who wait. False: the stage has enough to do, or this
  /// session waits for it already.
  bool wait(const ImageLevel& level, Waiting waiting);
  /// Who waited for a level that is now encoded; they wait no longer.
  std::vector<Waiting> take_waiting(const ImageLevel& level) { return waiting_.take(level); }
  void keep(const ImageLevel& level, Bytes bytes);
  void remove_session(SessionId session);
  /// Levels that a session waits for.
  std::size_t asks_of(SessionId session) const;

 private:
  BoundedQueue<ImageLevel>& jobs_;
  WaitList<ImageLevel, Waiting> waiting_;
  std::map<ImageLevel, Bytes> encoded_;
  ByteBudget<ImageLevel> budget_{256u << 20};  ///< of encoded_
};

}  // namespace mirage
