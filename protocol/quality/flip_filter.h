#pragma once
// FLIP filter: the separable filters of FLIP. The paper's two-dimensional kernels are products
// (colour: sums of two products) of the one-dimensional ones here, so two passes of ~20 taps
// replace ~400.

#include <cstddef>
#include <vector>

namespace mirage::flip {

/// A float for each pixel, rows top to bottom.
struct Plane {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<float> values;

  Plane() = default;
  Plane(std::size_t w, std::size_t h) : width(w), height(h), values(w * h) {}
};

/// Taps from -radius to +radius, radius = size / 2.
using Kernel = std::vector<float>;

/// One term of a contrast sensitivity function in the spatial domain: a sqrt(pi/b) exp(-pi^2 x^2 /
/// b), x in degrees.
struct CsfTerm {
  double a = 0;
  double b = 0;
};

/// A contrast sensitivity filter: weights[i] times the separable kernels[i]. The weights sum to 1.
struct CsfFilter {
  std::vector<Kernel> kernels;
  std::vector<float> weights;
};
CsfFilter csf_filter(const std::vector<CsfTerm>& terms, double pixels_per_degree);

/// Smoothing, and first and second derivative of the Gaussian that detects features. Positive taps
/// of a derivative sum to 1, negative ones to -1.
struct FeatureKernels {
  Kernel smooth;
  Kernel edge;
  Kernel point;
};
FeatureKernels feature_kernels(double pixels_per_degree);

/// Filters rows with `horizontal`, then columns with `vertical`; the border pixel repeats outside.
Plane convolve(const Plane& in, const Kernel& horizontal, const Kernel& vertical);
Plane convolve_rows(const Plane& in, const Kernel& kernel);
Plane convolve_columns(const Plane& in, const Kernel& kernel);
Plane apply(const CsfFilter& filter, const Plane& in);

}  // namespace mirage::flip
