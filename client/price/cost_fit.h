#pragma once
// Cost fit: fits a cost model to measured frames while they are drawn, by relative error. A frame
// that took many times the expected time (a stall, a suspended machine) weighs little. Times under
// a microsecond are ignored.

#include "client/price/cost_model.h"
#include "client/price/running_fit.h"

namespace mirage {

class CostFit {
 public:
  explicit CostFit(const CostModel& first, const RunningFitOptions& options = {});

  /// Learns that a frame with this work took `ms` milliseconds.
  void add(const FrameWork& work, double ms);
  const CostModel& model() const { return model_; }

 private:
  CostModel first_, model_;
  RunningFit<kWorks> fit_;
};

}  // namespace mirage
