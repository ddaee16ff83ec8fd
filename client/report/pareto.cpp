#include "client/report/pareto.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

bool dominates(const CostError& a, const CostError& b) {
  return a.cost <= b.cost && a.error <= b.error && (a.cost < b.cost || a.error < b.error);
}

}  // namespace

std::vector<bool> pareto_front(const std::vector<CostError>& points) {
  std::vector<bool> front;
  for (const CostError& point : points) {
    const bool measured = !std::isnan(point.cost) && !std::isnan(point.error);
    const bool beaten = std::any_of(points.begin(), points.end(), [&](const CostError& other) {
      return dominates(other, point);
    });
    front.push_back(measured && !beaten);
  }
  return front;
}

}  // namespace mirage
