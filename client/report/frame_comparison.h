#pragma once
// Frame comparison: draws the compared frames of a session run, and measures how far they are from
// the truth.
// Input:  a planned frame of the client.
// Output: its measures, in the result of the run.
// Thread: the GL thread.
// Full:   never.

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "client/report/session_run.h"

namespace mirage {

class Client;

class FrameComparison {
 public:
  /// `clock_ms` tells the time by which draws are measured. All must outlive this.
  FrameComparison(const RunSpec& spec, TruthSource& truth, std::function<double()> clock_ms,
                  RunResult& out)
      : spec_(spec), truth_(truth), clock_ms_(std::move(clock_ms)), out_(out) {}

  struct Drawn {
    int frame = 0;
    double planned_ms = 0;  ///< that planning it took
    int rested = 0;         ///< frames until now in which a viewer would have refined the picture
  };
  /// Draws the planned frame and compares it. Errors as TruthSource::at().
  Result<void> compare(Client& client, const Drawn& run);

 private:
  /// Adds the last drawn frame to the geometric error. Returns the share of its object pixels that
  /// are holes.
  double add_geometric(const PlannedFrame& planned, const ReferenceFrame& truth);

  const RunSpec& spec_;
  TruthSource& truth_;
  std::function<double()> clock_ms_;
  RunResult& out_;
  int before_ = -2;  ///< last compared frame
  std::vector<std::uint8_t> drawn_before_;
  ReferencePtr truth_before_;
};

}  // namespace mirage
