#pragma once
// Forms that keep their accuracy where the textbook ones lose it (numerics.md section 3).

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace mirage {

/// Angle in radians between two non-zero vectors, exact to rounding for small angles, where
/// acos(dot) loses half its digits: atan2(|a x (b-a)|, a.b).
inline double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  const double la = glm::length(a), lb = glm::length(b);
  if (!(la > 0) || !(lb > 0)) return std::numeric_limits<double>::quiet_NaN();
  const glm::dvec3 ua = a / la, ub = b / lb;
  return std::atan2(glm::length(glm::cross(ua, ub - ua)), glm::dot(ua, ub));
}

/// 1 - cos(x) without cancellation.
inline double one_minus_cos(double x) {
  const double s = std::sin(0.5 * x);
  return 2.0 * s * s;
}

/// sqrt(d^2 - r^2) for d >= r, without the cancellation of the difference of squares.
inline double tangent_length(double d, double r) { return std::sqrt((d - r) * (d + r)); }

/// 1 - exp(-x): the gain of a first-order filter, stable for tiny and for huge x.
inline double smoothing_gain(double x) { return -std::expm1(-x); }

/// Unit vector of any finite non-zero vector, without under- or overflow; zero when there is none
/// (zero, NaN or infinite input).
inline glm::dvec3 safe_normalize(const glm::dvec3& v) {
  const double m = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(m > 0) || !std::isfinite(m)) return glm::dvec3(0);
  if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return glm::dvec3(0);
  const glm::dvec3 scaled = v / m;
  return scaled / glm::length(scaled);
}

inline bool is_finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace mirage
