#pragma once
// A surface that loses triangles step by step.

#include <array>
#include <cstdint>
#include <vector>

#include "protocol/model/model.h"

namespace mirage {

/// Gives what meshopt_simplify() would on all vertices of the first surface, in time that goes with
/// what is left: of the other vertices it keeps those that have a say, which share a place with one
/// that is left, or span the box that errors are relative to.
class SurfaceSimplifier {
 public:
  /// `indices` refer to `vertices`; their count is a multiple of 3.
  /// `lock_border`: vertices at an edge of one triangle stay.
  SurfaceSimplifier(const std::vector<Vertex>& vertices, std::vector<std::uint32_t> indices,
                    bool lock_border = false);

  /// Largest edge of the box around all vertices, object units.
  double scale() const { return scale_; }
  /// Of what is left.
  std::size_t index_count() const { return indices_.size(); }

  struct Step {
    std::vector<std::uint32_t> indices;  ///< of vertices that are left; for take()
    double error = 0;                    ///< the simplifier's estimate, object units
  };
  /// With about `target` indices, where at most `error` (object units) is estimated.
  Step simplified(std::size_t target, double error) const;
  /// Goes on from there.
  void take(Step step);
  /// As indices of the first surface's vertices.
  std::vector<std::uint32_t> full_indices(const std::vector<std::uint32_t>& indices) const;

 private:
  std::vector<glm::vec3> positions_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint32_t> full_;    ///< by vertex that is left: its index among the first
  std::vector<std::uint32_t> place_;   ///< by vertex that is left: number of its position
  std::size_t places_ = 0;             ///< numbers of positions
  std::array<std::uint32_t, 6> span_;  ///< positions that the box is spanned by
  double scale_ = 0;
  unsigned options_ = 0;  ///< meshopt_simplify()'s
};

}  // namespace mirage
