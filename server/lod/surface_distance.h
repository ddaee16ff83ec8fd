#pragma once
// How far points lie from a triangle surface.

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

  /// Distance from `p` to the surface, or `at_most` when it is farther than that.
  double distance(const glm::vec3& p, double at_most) const;
  /// The same where it is above `floor`, else anything up to `floor`. For the largest distance of
  /// many points: most of them are soon known not to be it. `near` is where the search begins, a
  /// place in the tree, and where it ended: the next point's neighbourhood.
  double distance_above(double floor, const glm::vec3& p, double at_most,
                        std::uint32_t& near) const;
  /// What the vertices say of the point of the surface nearest to `p`, interpolated: a unit normal
  /// (zero where there is none) and the colour, 0 to 1, linear.
  struct Shading {
    glm::vec3 normal{0};
    glm::vec4 color{0};
  };
  Shading shading_at(const glm::vec3& p) const;
  /// The same, `near` as above. Where several triangles are equally near, it decides.
  Shading shading_at(const glm::vec3& p, std::uint32_t& near) const;
  /// By vertex: a place in the tree of one of its triangles.
  std::vector<std::uint32_t> places_of_vertices() const;

 private:
  using Lanes = FourTriangles::Lanes;
  /// Both children's boxes, side by side: one line of the cache for each step down.
  struct alignas(64) Node {
    Lanes bounds[3];         ///< by axis: the least values of both, then the greatest with minus
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
  /// Makes the tree over `count` triangles, its inner nodes from `at` on, its leaves from `leaf`
  /// on; gives its box. At least two leaves.
  Box build(std::uint32_t at, std::uint32_t leaf, Center* centers, std::uint32_t count,
            const Workers& workers);
  Box make_leaf(std::uint32_t leaf, const Center* centers, std::uint32_t count);
  glm::vec3 corner(std::uint32_t place, std::size_t number) const;
  void try_triangle(std::uint32_t place, const glm::vec3& p, Nearest& best) const;
  void try_leaf(std::uint32_t leaf, const glm::vec3& p, Nearest& best) const;
  /// Ends as soon as something within `enough2` is found.
  void search(const glm::vec3& p, float enough2, Nearest& best) const;

  const std::vector<Vertex>& vertices_;
  const std::vector<std::uint32_t>& indices_;
  std::vector<std::uint32_t> order_;   ///< by place: the triangle; a leaf has four places
  std::vector<FourTriangles> leaves_;  ///< their corners
  std::vector<Node> nodes_;            ///< inner ones
  std::uint32_t root_ = 0;             ///< as Node::child
};

}  // namespace mirage
