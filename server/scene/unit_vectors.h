#pragma once
// Directions of vertices, made safe for any content of a file.

#include <cmath>
#include <glm/glm.hpp>

namespace mirage {

/// True if `v` is neither zero, NaN nor infinite.
inline bool has_direction(const glm::vec3& v) {
  const double length2 = glm::dot(glm::dvec3(v), glm::dvec3(v));
  return length2 > 0 && std::isfinite(length2);
}

/// Returns a unit vector perpendicular to the unit vector `normal`.
inline glm::vec3 perpendicular(const glm::vec3& normal) {
  // The axis least aligned with the normal keeps the cross product long.
  const glm::vec3 size = glm::abs(normal);
  const glm::vec3 axis = size.x <= size.y && size.x <= size.z ? glm::vec3(1, 0, 0)
                         : size.y <= size.z                   ? glm::vec3(0, 1, 0)
                                                              : glm::vec3(0, 0, 1);
  return glm::normalize(axis - normal * glm::dot(normal, axis));
}

/// Returns `v` at unit length, or `fallback` if it has no direction (zero, NaN, infinite).
inline glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& fallback) {
  if (!has_direction(v)) return fallback;
  return glm::vec3(glm::normalize(glm::dvec3(v)));
}

}  // namespace mirage
