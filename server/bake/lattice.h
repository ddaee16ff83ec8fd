#pragma once
// Directions from which a bake captures an object: the vertices of a lattice, as engines expect
// them. Space: glTF's (x right, y up, z to the viewer). Formulas: numerics.md section 7.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>

namespace mirage {

enum class BakeLayout : std::uint8_t {
  kHemi,        ///< upper half of the sphere, unfolded to a square turned by 45 degrees
  kOctahedral,  ///< whole sphere; frames at the border come twice
  kRing,        ///< grid * grid directions around the horizon
};
std::string_view name_of(BakeLayout layout);
std::optional<BakeLayout> layout_of(std::string_view name);

/// Grids that make sense: fewer frames cannot be blended, more do not fit a texture.
constexpr int kFewestFrames = 2, kMostFrames = 64;

/// Returns the direction from the centre to the camera of frame (i, j), unit length. `grid`: frames
/// a side. For a ring, the frame's number is j * grid + i.
glm::dvec3 frame_direction(BakeLayout layout, int grid, int i, int j);

/// The inverse: returns where in the lattice a direction lies, 0 to grid - 1 each way. A hemi
/// lattice takes directions below the horizon as those on it. Not for a ring.
glm::dvec2 lattice_place(BakeLayout layout, int grid, const glm::dvec3& direction);

/// How a frame is rolled. Away from the poles, right is horizontal for everybody:
/// normalize(cross(+y, direction)).
struct RollRule {
  /// above this |direction.y|, `polar_up` takes the place of +y
  double polar_from = 1 - 1e-9;
  glm::dvec3 polar_up{0, 0, -1};
};

/// Axes of a frame's picture, unit length and orthogonal; `toward` is its direction.
struct FrameBasis {
  glm::dvec3 right, up, toward;
};
FrameBasis frame_basis(const RollRule& rule, const glm::dvec3& direction);

/// The three frames that a direction lies between, and their weights, which sum to 1.
struct FrameBlend {
  std::array<glm::ivec2, 3> frame;
  std::array<double, 3> weight;
};
FrameBlend frame_blend(BakeLayout layout, int grid, const glm::dvec3& direction);

}  // namespace mirage
