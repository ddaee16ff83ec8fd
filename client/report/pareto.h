#pragma once
#include <vector>

namespace mirage {

/// A setting's cost and error; both are better when smaller.
struct CostError {
  double cost = 0;
  double error = 0;
};

/// Returns for each point whether it is on the Pareto front: no other point is at least as good in
/// both and better in one. Equal points are all on it or all off it. A point with a NaN is never on
/// it, and dominates nothing.
std::vector<bool> pareto_front(const std::vector<CostError>& points);

}  // namespace mirage
