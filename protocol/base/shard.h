#pragma once
// Shard: one of several equal parts of a work, as a batch scheduler hands them out.

#include <cstddef>
#include <string>

#include "protocol/base/result.h"

namespace mirage {

struct Shard {
  unsigned index = 0, count = 1;  ///< index < count
  bool has(std::size_t item) const { return item % count == index; }
};

/// Reads "I/N", 0 <= I <= N, 1 <= N <= 999,999. N/N is the same shard as 0/N, so that a scheduler
/// may count from 0 or from 1. Error kUsage.
Result<Shard> parse_shard(const std::string& text);

}  // namespace mirage
