#pragma once
// How far the vertices of an object reach over many poses, and how far they go from one to another.

#include <array>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

namespace mirage {

/// An axis-aligned box; empty at first.
struct PointBox {
  glm::vec3 low{std::numeric_limits<float>::infinity()};
  glm::vec3 high{-std::numeric_limits<float>::infinity()};
  void add(const std::vector<glm::vec3>& points);
};

/// The extremes of everything that is added.
class PosedExtent {
 public:
  /// Across the faces, edges and corners of a cube, as enclosing_hull() has its planes.
  static constexpr std::size_t kDirections = 26;

  /// `center`: any point; where the bounding sphere is to be.
  explicit PosedExtent(const glm::vec3& center);

  /// Finite ones. Few poses reach farther than those before: where single precision shows that 64
  /// points do not, they are not looked at one by one.
  void add(const std::vector<glm::vec3>& points);

  const glm::vec3& center() const { return center_; }
  const PointBox& box() const { return box_; }
  /// Squared, of the sphere around `center`.
  double radius2() const { return radius2_; }
  const std::array<glm::dvec3, kDirections>& directions() const { return directions_; }
  /// By direction: the point that is farthest in it, the first where there are several.
  const std::array<glm::dvec3, kDirections>& points() const { return points_; }

 private:
  void add_block(const glm::vec3* points, std::size_t count);

  const glm::vec3 center_;
  const std::array<glm::dvec3, kDirections> directions_;
  PointBox box_;
  double radius2_ = 0;
  std::array<double, kDirections> support_;
  std::array<glm::dvec3, kDirections> points_{};
};

/// The largest distance between a point of `a` and that of `b` with the same index.
double largest_step(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b);

}  // namespace mirage
