#pragma once
// Asks for the ground around somebody who walks, a few blocks at a time.
// Input:  where the walker is; refusals.
// Output: requests.
// Thread: the frame loop's.
// Full:   never; a few requests at a time.

#include <cstdint>
#include <map>
#include <vector>

#include "protocol/model/ground.h"

namespace mirage {

class GroundMap;

class GroundAsks {
 public:
  /// Restarts for a new connection, where the requested blocks will not come.
  void reset() { pending_.clear(); }
  /// Returns the blocks to ask for now, nearest first.
  std::vector<GroundBlockId> plan(const GroundMap& map, double x, double z,
                                  std::int64_t now_us) const;
  /// Notes that a block was asked for by this number.
  void asked(std::uint32_t request_id, GroundBlockId block) { pending_[request_id] = block; }
  /// Ends a request that was answered; false: it was for another block, or not asked for.
  bool finish(std::uint32_t request_id, GroundBlockId block);
  /// Takes a refusal; returns true if it was for ground.
  bool refused(std::uint32_t request_id, std::int64_t now_us);

 private:
  std::map<std::uint32_t, GroundBlockId> pending_;  ///< by number of the request
  std::int64_t not_before_us_ = INT64_MIN;
};

}  // namespace mirage
