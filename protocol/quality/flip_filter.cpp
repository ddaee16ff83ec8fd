#include "protocol/quality/flip_filter.h"

#include <algorithm>
#include <cmath>

namespace mirage::flip {
namespace {

constexpr double kPi = 3.14159265358979323846;
// The reference uses 3 standard deviations of the widest term of all three channels for each
// channel.
constexpr double kWidestB = 0.04;
constexpr double kFeatureWidthDegrees = 0.082;
// Taps this much below the largest one are beyond float's digits in the sum, so they are left out.
constexpr double kNegligibleTap = 1e-9;

/// Drops negligible taps equally at both ends.
Kernel trimmed(const std::vector<double>& taps) {
  const double largest = *std::max_element(taps.begin(), taps.end());
  std::size_t cut = 0;
  while (cut < taps.size() / 2 && taps[cut] < largest * kNegligibleTap) ++cut;
  Kernel kernel;
  for (std::size_t i = cut; i + cut < taps.size(); ++i) {
    kernel.push_back(static_cast<float>(taps[i]));
  }
  return kernel;
}

double sum_of(const std::vector<double>& taps) {
  double sum = 0;
  for (const double t : taps) sum += t;
  return sum;
}

/// Scales positive taps to a sum of 1 and negative taps to a sum of -1.
Kernel balanced(const std::vector<double>& taps) {
  double positive = 0, negative = 0;
  for (const double t : taps) (t > 0 ? positive : negative) += std::abs(t);
  Kernel kernel;
  for (const double t : taps) {
    kernel.push_back(static_cast<float>(t / std::max(t > 0 ? positive : negative, 1e-300)));
  }
  return kernel;
}

void accumulate(float* out, const float* in, float weight, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) out[i] += weight * in[i];
}

}  // namespace

CsfFilter csf_filter(const std::vector<CsfTerm>& terms, double pixels_per_degree) {
  const int radius = static_cast<int>(
      std::ceil(3.0 * std::sqrt(kWidestB / (2.0 * kPi * kPi)) * pixels_per_degree));
  CsfFilter filter;
  std::vector<double> weights;
  for (const CsfTerm& term : terms) {
    std::vector<double> taps;
    for (int i = -radius; i <= radius; ++i) {
      const double x = i / pixels_per_degree;
      taps.push_back(std::exp(-kPi * kPi * x * x / term.b));
    }
    const double sum = sum_of(taps);
    weights.push_back(term.a * std::sqrt(kPi / term.b) * sum * sum);
    for (double& t : taps) t /= sum;
    filter.kernels.push_back(trimmed(taps));
  }
  const double total = sum_of(weights);
  for (const double w : weights) filter.weights.push_back(static_cast<float>(w / total));
  return filter;
}

FeatureKernels feature_kernels(double pixels_per_degree) {
  const double sigma = 0.5 * kFeatureWidthDegrees * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<double> smooth, edge, point;
  for (int i = -radius; i <= radius; ++i) {
    const double g = std::exp(-i * i / (2.0 * sigma * sigma));
    smooth.push_back(g);
    edge.push_back(-i * g);
    point.push_back((i * i / (sigma * sigma) - 1.0) * g);
  }
  return {balanced(smooth), balanced(edge), balanced(point)};
}

Plane convolve_rows(const Plane& in, const Kernel& kernel) {
  Plane out(in.width, in.height);
  const std::size_t radius = kernel.size() / 2;
  std::vector<float> padded(in.width + 2 * radius);
  for (std::size_t y = 0; y < in.height; ++y) {
    const float* row = in.values.data() + y * in.width;
    std::fill_n(padded.begin(), radius, row[0]);
    std::copy_n(row, in.width, padded.begin() + static_cast<std::ptrdiff_t>(radius));
    std::fill_n(padded.end() - static_cast<std::ptrdiff_t>(radius), radius, row[in.width - 1]);
    float* out_row = out.values.data() + y * in.width;
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      accumulate(out_row, padded.data() + k, kernel[k], in.width);
    }
  }
  return out;
}

Plane convolve_columns(const Plane& in, const Kernel& kernel) {
  Plane out(in.width, in.height);
  const auto radius = static_cast<std::ptrdiff_t>(kernel.size() / 2);
  const auto last = static_cast<std::ptrdiff_t>(in.height) - 1;
  for (std::ptrdiff_t y = 0; y <= last; ++y) {
    float* out_row = out.values.data() + static_cast<std::size_t>(y) * in.width;
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const std::ptrdiff_t source =
          std::clamp<std::ptrdiff_t>(y + static_cast<std::ptrdiff_t>(k) - radius, 0, last);
      accumulate(out_row, in.values.data() + static_cast<std::size_t>(source) * in.width, kernel[k],
                 in.width);
    }
  }
  return out;
}

Plane convolve(const Plane& in, const Kernel& horizontal, const Kernel& vertical) {
  return convolve_columns(convolve_rows(in, horizontal), vertical);
}

Plane apply(const CsfFilter& filter, const Plane& in) {
  Plane out(in.width, in.height);
  for (std::size_t i = 0; i < filter.kernels.size(); ++i) {
    const Plane part = convolve(in, filter.kernels[i], filter.kernels[i]);
    accumulate(out.values.data(), part.values.data(), filter.weights[i], out.values.size());
  }
  return out;
}

}  // namespace mirage::flip
