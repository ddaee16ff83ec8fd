#pragma once
// Distances from points to a triangle surface.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "protocol/model/model.h"
#include "server/base/workers.h"
#include "server/lod/four_triangles.h"

namespace mirage {

/// A bounding-volume tree over triangles.
class SurfaceTree {
 public:
  /// `indices` refer to `vertices`, which must outlive the tree; their count is a multiple of 3.
  SurfaceTree(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& indices,
              const Workers& workers = Workers());

  /// Returns the distance from `p` to the surface, `at_most` if it is farther.
  double distance(const glm::vec3& p, double at_most) const;
  /// Returns the distance if it is above `floor`, else any value up to `floor`. It serves searches
  /// for the largest distance of many points: most points soon prove to be nearer. `near` is a
  /// place in the tree: the search begins there, and it is set to where the search ended, which is
  /// close to the next point.
  double distance_above(double floor, const glm::vec3& p, double at_most,
                        std::uint32_t& near) const;
  /// Shading at the point of the surface nearest to `p`, interpolated from vertices: a unit normal
  /// (zero if there is none), and the colour, 0 to 1, linear.
  struct Shading {
    glm::vec3 normal{0};
    glm::vec4 color{0};
  };
  Shading shading_at(const glm::vec3& p) const;
  /// Returns the shading, with `near` as above. Among equally near triangles, `near` decides.
  Shading shading_at(const glm::vec3& p, std::uint32_t& near) const;
  /// Returns, for each vertex, a place in the tree of one of its triangles.
  std::vector<std::uint32_t> places_of_vertices() const;

 private:
  using Lanes = FourTriangles::Lanes;
  /// The boxes of both children side by side, so that each step down reads one cache line.
  struct alignas(64) Node {
    /// by axis: least values of both children, then negated greatest values
    Lanes bounds[3];
    std::uint32_t child[2];  ///< an inner node, or a leaf (kLeaf)
  };
  struct Box {
    glm::vec3 low, high;
  };
  struct Center {
    glm::vec3 at;
    std::uint32_t triangle;
  };
  struct Nearest {
    float distance2;
    std::uint32_t place;
    glm::vec3 point;
  };
  /// Builds the tree over `count` triangles, with inner nodes from `at` on and leaves from `leaf`
  /// on. Returns its box. Needs at least two leaves.
  Box build(std::uint32_t at, std::uint32_t leaf, Center* centers, std::uint32_t count,
            const Workers& workers);
  Box make_leaf(std::uint32_t leaf, const Center* centers, std::uint32_t count);
  glm::vec3 corner(std::uint32_t place, std::size_t number) const;
  void try_triangle(std::uint32_t place, const glm::vec3& p, Nearest& best) const;
  void try_leaf(std::uint32_t leaf, const glm::vec3& p, Nearest& best) const;
  /// Ends the search as soon as a point within `enough2` is found.
  void search(const glm::vec3& p, float enough2, Nearest& best) const;

  const std::vector<Vertex>& vertices_;
  const std::vector<std::uint32_t>& indices_;
  std::vector<std::uint32_t> order_;   ///< by place: the triangle; a leaf has four places
  std::vector<FourTriangles> leaves_;  ///< their corners
  std::vector<Node> nodes_;            ///< inner ones
  std::uint32_t root_ = 0;             ///< as Node::child
};

}  // namespace mirage
