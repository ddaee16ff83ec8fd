#pragma once
// Surfaces that another one covers exactly, such as the copy of a rock that stands for it in
// collisions. Which of the two is seen would be decided by rounding, in each tile and each level
// anew.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mirage {

struct Scene;

/// Count of what was left out because later triangles of the scene lie on the same three corners.
struct Covered {
  std::size_t triangles = 0;  ///< not seen from one side or either, over instances that are drawn
  std::size_t instances = 0;  ///< nothing of them is seen
  /// The source of each material appended to the scene, which is its single-sided form.
  std::vector<std::uint32_t> materials = {};
};

/// Leaves out sides of opaque and alpha-tested triangles that a later opaque triangle covers: same
/// corners, within the rounding of the transforms. The later one is seen, as a depth test that lets
/// equal depths pass would have it. Later means a later instance, or a later triangle of the same
/// mesh. A triangle of which one side is left becomes single-sided. Objects that move stay as they
/// are.
Covered leave_out_covered(Scene& scene);

}  // namespace mirage
