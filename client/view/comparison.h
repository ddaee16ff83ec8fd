#pragma once
// Comparison: compares what was drawn with the server's full render of the same camera.

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

struct PlannedFrame;
struct ReferenceFrame;
class SessionStats;

class Comparison {
 public:
  struct Frame {
    const PlannedFrame& planned;
    const std::vector<std::uint8_t>& drawn;  ///< RGBA, sRGB, rows from the top
    const ReferenceFrame& reference;
    std::uint64_t number;
    int supersample;  ///< of the reference, samples a side of a pixel
  };
  /// Measures the frame into `stats`, and its flicker if the frame before it was compared. Writes
  /// reference, difference (times 2) and a heat map of FLIP into `out_dir` unless that is empty.
  /// Error kIo.
  Result<void> add(const Frame& frame, SessionStats& stats, const std::string& out_dir);

 private:
  struct {
    std::uint64_t number = UINT64_MAX - 1;
    std::vector<std::uint8_t> drawn, truth;
  } before_;
};

}  // namespace mirage
