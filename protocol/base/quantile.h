#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

namespace mirage {

/// Returns the nearest-rank quantile for q in [0, 1]; 0 if there are no values.
template <typename T>
T quantile(std::vector<T> values, double q) {
  if (values.empty()) return T{};
  const auto last = static_cast<double>(values.size() - 1);
  const auto rank = static_cast<std::ptrdiff_t>(std::lround(q * last));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace mirage
