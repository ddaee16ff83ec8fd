#pragma once
// How far points lie from a triangle surface.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "protocol/model.h"

namespace mirage {

/// A bounding-volume tree over triangles.
class SurfaceTree {
 public:
  /// `indices` refer to `vertices`, which must outlive the tree; their count is a multiple of 3.
  SurfaceTree(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& indices);

  /// Distance from `p` to the surface, or `at_most` when it is farther than that.
  double distance(const glm::vec3& p, double at_most) const;
  /// What the vertices say of the point of the surface nearest to `p`, interpolated: a unit normal
  /// (zero where there is none) and the colour, 0 to 1, linear.
  struct Shading {
    glm::vec3 normal{0};
    glm::vec4 color{0};
  };
  Shading shading_at(const glm::vec3& p) const;

 private:
  struct Node {
    glm::vec3 low{0}, high{0};
    std::uint32_t first = 0;  ///< triangle of a leaf, or the right child (the left one follows)
    std::uint32_t count = 0;  ///< of a leaf; 0: inner node
  };
  void build(std::uint32_t first, std::uint32_t count, std::vector<glm::vec3>& centers);
  struct Nearest {
    float distance2;
    std::uint32_t triangle;
    glm::vec3 point;
  };
  void search(std::uint32_t node, const glm::vec3& p, Nearest& best) const;

  const std::vector<Vertex>& vertices_;
  const std::vector<std::uint32_t>& indices_;
  std::vector<std::uint32_t> order_;  ///< triangles, grouped by leaf
  std::vector<Node> nodes_;
};

/// Closest point of triangle abc to p (C. Ericson, Real-Time Collision Detection, 5.1.5).
glm::vec3 closest_on_triangle(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b,
                              const glm::vec3& c);

}  // namespace mirage
