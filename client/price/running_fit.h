#pragma once
// Running fit: least squares with limits, over rows seen lately. It finds factors x, each within [1
// / range, range], so that row . x is near the row's target. Factors that the rows do not tell
// apart stay near 1. It uses coordinate descent on the normal equations: the problem is convex, its
// limits are a box, and the next answer is near the last.

#include <algorithm>
#include <array>
#include <cstddef>

namespace mirage {

struct RunningFitOptions {
  double kept = 0.95;   ///< weight that a row keeps with each later row; 1: forgets none
  double prior = 1e-3;  ///< weight of 1 for each factor, in squared units of the target
  double range = 16;
};

template <std::size_t N>
class RunningFit {
 public:
  using Row = std::array<double, N>;

  explicit RunningFit(const RunningFitOptions& options = {}) : options_(options) {
    factors_.fill(1);
  }

  /// Adds a row. All numbers are finite; weight >= 0.
  void add(const Row& row, double target, double weight) {
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t k = 0; k < N; ++k) {
        products_[i][k] = options_.kept * products_[i][k] + weight * row[i] * row[k];
      }
      sums_[i] = options_.kept * sums_[i] + weight * row[i] * target;
    }
    for (int sweep = 0; sweep < kSweeps; ++sweep) descend();
  }
  const Row& factors() const { return factors_; }

 private:
  static constexpr int kSweeps = 8;

  void descend() {
    for (std::size_t i = 0; i < N; ++i) {
      double rest = sums_[i] + options_.prior;
      for (std::size_t k = 0; k < N; ++k) {
        if (k != i) rest -= products_[i][k] * factors_[k];
      }
      const double best = rest / (products_[i][i] + options_.prior);
      factors_[i] = std::clamp(best, 1 / options_.range, options_.range);
    }
  }

  RunningFitOptions options_;
  Row factors_{};
  std::array<Row, N> products_{};
  Row sums_{};
};

}  // namespace mirage
