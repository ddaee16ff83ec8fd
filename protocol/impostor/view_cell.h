#pragma once
// View cells: the quantised object-space view vector (object centre -> eye) as an octahedral cell
// and a logarithmic distance bucket. Both carry their level, so a key names its own fineness.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

namespace mirage {

/// Octahedral cell (x, y) of the 2^level x 2^level texel-centred grid over the sphere.
struct ViewCell {
  std::uint8_t level = 0;  ///< 0 .. limits::kMaxViewLevel
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  friend bool operator==(const ViewCell& a, const ViewCell& b) {
    return a.level == b.level && a.x == b.x && a.y == b.y;
  }
};

/// Bucket of D/r: covers [2^(index/2^level), 2^((index+1)/2^level)), captured at its middle.
struct DistanceBucket {
  std::uint8_t level = 0;  ///< 0 .. limits::kMaxDistanceLevel
  std::int32_t index = 0;
  friend bool operator==(const DistanceBucket& a, const DistanceBucket& b) {
    return a.level == b.level && a.index == b.index;
  }
};

/// Returns the cell that holds the direction `v` (any finite non-zero length); nullopt for zero or
/// NaN.
std::optional<ViewCell> view_cell_from_direction(const glm::dvec3& v, int level);
/// Returns the unit direction of the cell's centre.
glm::dvec3 direction_from_view_cell(const ViewCell& cell);
/// Returns the largest angle in radians between a direction in a cell of this level and its centre
/// (3 sqrt 2 / n, reached at the middle of an octahedron face).
double view_cell_angle(int level);
/// Returns the coarsest level whose cells stay within `angle` radians of their centre.
int view_level_for_angle(double angle);
bool valid(const ViewCell& cell);

/// Returns the bucket of `distance_radii` = D/r, clamped to the capture range; nullopt if it is not
/// finite or not positive.
std::optional<DistanceBucket> distance_bucket_from_radii(double distance_radii, int level);
/// Returns D/r at the bucket's (geometric) middle, where tiles are captured.
double radii_from_distance_bucket(const DistanceBucket& bucket);
bool valid(const DistanceBucket& bucket);

/// Orthonormal capture frame of a cell: `forward` looks from the capture eye at the centre. The
/// roll depends on the cell alone, never on a viewer; world-up chooses it away from the poles.
struct CaptureBasis {
  glm::dvec3 right{1, 0, 0};
  glm::dvec3 up{0, 1, 0};
  glm::dvec3 forward{0, 0, -1};
};
CaptureBasis capture_basis(const ViewCell& cell);

}  // namespace mirage
