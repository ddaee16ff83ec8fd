#pragma once
// Running fit of a cost model to frames that were measured, by relative error. A frame that took
// many times what was expected (a stall, a suspended machine) weighs little; what is no time weighs
// nothing.

#include "client/price/cost_model.h"
#include "client/price/running_fit.h"

namespace mirage {

class CostFit {
 public:
  explicit CostFit(const CostModel& first, const RunningFitOptions& options = {});

  /// A frame took `ms`.
  void add(const FrameWork& work, double ms);
  const CostModel& model() const { return model_; }

 private:
  CostModel first_, model_;
  RunningFit<kWorks> fit_;
};

}  // namespace mirage
