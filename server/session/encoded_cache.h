#pragma once
// Encoded parts of the scene (images, ground), and the requests that wait for one under way.
// Input:  requests; parts that a stage has encoded
// Output: jobs of that stage
// Thread: the network loop's
// Full:   the part encoded longest ago is dropped first

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "protocol/base/bounded_queue.h"
#include "server/base/byte_budget.h"
#include "server/base/wait_list.h"
#include "server/tile/tile_job.h"

namespace mirage {

template <typename Key, typename Encoded>
class EncodedCache {
 public:
  /// A session and its request.
  using Waiting = std::pair<SessionId, std::uint32_t>;

  EncodedCache(BoundedQueue<Key>& jobs, std::size_t most_bytes)
      : jobs_(jobs), budget_(most_bytes) {}

  /// Returns a part; nullptr: not here.
  const Encoded* find(const Key& key) const {
    const auto at = encoded_.find(key);
    return at == encoded_.end() ? nullptr : &at->second;
  }
  /// Requests a part, encoded once for all its waiters. False: the stage is full, or this session
  /// waits for the part already.
  bool wait(const Key& key, Waiting waiting) {
    const bool again =
        waiting_.any(key, [&](const Waiting& other) { return other.first == waiting.first; });
    if (again) return false;
    Key job = key;
    if (!waiting_.under_way(key) && !jobs_.try_push(job)) return false;
    waiting_.add(key, waiting);
    return true;
  }
  /// Ends the encoding of a part and returns its waiters.
  std::vector<Waiting> take_waiting(const Key& key) { return waiting_.take(key); }
  void keep(const Key& key, Encoded encoded, std::size_t bytes) {
    budget_.add(key, bytes);
    encoded_[key] = std::move(encoded);
    while (const std::optional<Key> oldest = budget_.take_excess()) encoded_.erase(*oldest);
  }
  void remove_session(SessionId session) {
    // A part under way is still encoded and kept for later requests.
    waiting_.remove([&](const Waiting& waiting) { return waiting.first == session; },
                    [](const Key&) { return false; });
  }
  /// Number of parts that a session waits for.
  std::size_t asks_of(SessionId session) const {
    return waiting_.count([&](const Waiting& waiting) { return waiting.first == session; });
  }

 private:
  BoundedQueue<Key>& jobs_;
  WaitList<Key, Waiting> waiting_;
  std::map<Key, Encoded> encoded_;
  ByteBudget<Key> budget_;  ///< of encoded_
};

struct EncodedParts {
  EncodedCache<ImageLevel, Bytes> images;
  EncodedCache<GroundBlockId, EncodedGround> grounds;
};

}  // namespace mirage
