#pragma once
// Encoded images, and the asks that wait for a level under way.
// Input:  asks for levels; encoded levels
// Output: jobs of the image stage
// Thread: the network loop's
// Full:   the level encoded longest ago is dropped first

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

  /// Returns an encoded level, empty if encoding failed; nullptr: not here.
  const Bytes* find(const ImageLevel& level) const;
  /// Requests a level, encoded once for all its waiters. False: the stage is full, or this session
  /// waits for the level already.
  bool wait(const ImageLevel& level, Waiting waiting);
  /// Ends the encoding of a level and returns its waiters.
  std::vector<Waiting> take_waiting(const ImageLevel& level) { return waiting_.take(level); }
  void keep(const ImageLevel& level, Bytes bytes);
  void remove_session(SessionId session);
  /// Number of levels that a session waits for.
  std::size_t asks_of(SessionId session) const;

 private:
  BoundedQueue<ImageLevel>& jobs_;
  WaitList<ImageLevel, Waiting> waiting_;
  std::map<ImageLevel, Bytes> encoded_;
  ByteBudget<ImageLevel> budget_{256u << 20};  ///< of encoded_
};

}  // namespace mirage
