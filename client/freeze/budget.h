#pragma once
// Budget: which files of a freeze stay when all would take too many bytes.

#include <cstdint>
#include <string>
#include <vector>

#include "client/freeze/frozen_part.h"

namespace mirage {

struct Kept {
  std::vector<std::pair<std::string, FrozenEntry>> files;  ///< by name, rising
  std::vector<std::string> left_out;                       ///< the worst loss first
  std::uint64_t bytes = 0;                                 ///< of the files that stay
};

/// Chooses files of at most `most_bytes` together. Geometry and its images go first, the smallest
/// before others: a coarse level serves every view. Tiles that nothing
/// replaces follow, and then those beside geometry; each by what they were worth per byte.
Kept within_budget(const FrozenPart& part, std::uint64_t most_bytes);

}  // namespace mirage
