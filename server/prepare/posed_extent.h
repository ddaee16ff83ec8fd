#pragma once
// The reach of an object's vertices over many poses, and their way from pose to pose.

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

/// The extremes of all points that are added.
class PosedExtent {
 public:
  /// Directions through the faces, edges and corners of a cube, like the planes of
  /// enclosing_hull().
  static constexpr std::size_t kDirections = 26;

  /// `center`: middle of the bounding sphere; any point.
  explicit PosedExtent(const glm::vec3& center);

  /// Adds finite points. Few poses reach farther than earlier ones. If float arithmetic shows that
  /// 64 points do not, they are not examined one by one.
  void add(const std::vector<glm::vec3>& points);

  const glm::vec3& center() const { return center_; }
  const PointBox& box() const { return box_; }
  /// Squared radius of the sphere around `center`.
  double radius2() const { return radius2_; }
  const std::array<glm::dvec3, kDirections>& directions() const { return directions_; }
  /// Returns, for each direction, the point farthest in it, the first of several.
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

/// Returns the largest distance between points of `a` and `b` with the same index.
double largest_step(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b);

}  // namespace mirage
