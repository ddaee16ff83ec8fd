#pragma once
// A surface that is simplified step by step.

#include <array>
#include <cstdint>
#include <vector>

#include "protocol/model/model.h"

namespace mirage {

/// Gives the result of meshopt_simplify() on all vertices of the first surface, in time
/// proportional to the present triangles. It drops the vertices that no longer matter. It keeps
/// those that share a position with a present one, and those that span the box to which errors are
/// relative.
class SurfaceSimplifier {
 public:
  /// `indices` refer to `vertices`; their count is a multiple of 3. `lock_border`: vertices at
  /// edges of one triangle stay.
  SurfaceSimplifier(const std::vector<Vertex>& vertices, std::vector<std::uint32_t> indices,
                    bool lock_border = false);

  /// Returns the largest edge of the box around all vertices, object units.
  double scale() const { return scale_; }

  struct Step {
    std::vector<std::uint32_t> indices;  ///< into the present vertices; for take()
    double error = 0;                    ///< the simplifier's estimate, object units
  };
  /// Returns a step to about `target` indices, with an estimated error of at most `error` object
  /// units.
  Step simplified(std::size_t target, double error) const;
  /// Makes a step the present surface.
  void take(Step step);
  /// Converts indices of present vertices into those of the first surface.
  std::vector<std::uint32_t> full_indices(const std::vector<std::uint32_t>& indices) const;

 private:
  std::vector<glm::vec3> positions_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint32_t> full_;    ///< by present vertex: its index in the first surface
  std::vector<std::uint32_t> place_;   ///< by present vertex: number of its position
  std::size_t places_ = 0;             ///< number of positions
  std::array<std::uint32_t, 6> span_;  ///< positions that span the box
  double scale_ = 0;
  unsigned options_ = 0;  ///< options of meshopt_simplify()
};

}  // namespace mirage
