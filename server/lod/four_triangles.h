#pragma once
// The nearest point of four triangles, computed at once.

#include <array>
#include <cstddef>
#include <glm/glm.hpp>

namespace mirage {

/// Four triangles, Stored by corner and axis, one lane for each triangle, so that one instruction
/// handles all four..
class FourTriangles {
 public:
  typedef float Lanes __attribute__((vector_size(16)));

  void set(std::size_t lane, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    for (int axis = 0; axis < 3; ++axis) {
      corners_[0][axis][lane] = a[axis];
      corners_[1][axis][lane] = b[axis];
      corners_[2][axis][lane] = c[axis];
    }
  }
  /// Returns corner `number`, 0 to 2, of a triangle.
  glm::vec3 corner(std::size_t lane, std::size_t number) const {
    const std::array<Lanes, 3>& at = corners_[number];
    return {at[0][lane], at[1][lane], at[2][lane]};
  }

  struct Nearest {
    Lanes distance2;
    std::array<Lanes, 3> point;
  };
  /// Returns the nearest point of each triangle, identical to closest_on_triangle() to the bit.
  Nearest nearest(const glm::vec3& p) const;

 private:
  std::array<std::array<Lanes, 3>, 3> corners_;  ///< by corner and axis
};

/// Returns the point of triangle abc closest to p (C. Ericson, Real-Time Collision Detection,
/// 5.1.5).
glm::vec3 closest_on_triangle(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b,
                              const glm::vec3& c);

}  // namespace mirage
