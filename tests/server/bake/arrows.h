#pragma once
// An object whose pictures show how they are turned: a red bar along +x, a green one along +y, a
// blue one along +z, of different lengths, and a white ball off the middle. It is exact: rays and
// distances are computed, not sampled.

#include <glm/glm.hpp>
#include <optional>

#include "server/bake/master.h"

namespace mirage {

/// The object's own centre, away from the origin, and the radius of a sphere around all of it.
inline const glm::dvec3 kArrowsCenter{3, 1, -2};
inline constexpr double kArrowsRadius = 2.5;

/// Ends of the bars, seen from the centre, in radii.
inline constexpr double kRedEnd = .9, kGreenEnd = .75, kBlueEnd = .6;

struct SurfaceHit {
  glm::dvec3 point, normal, color;  // linear
};
/// Returns what a ray hits first. `toward`: unit length, against the ray.
std::optional<SurfaceHit> hit_arrows(const glm::dvec3& origin, const glm::dvec3& toward);
/// Returns how far a point is from the surface.
double distance_to_arrows(const glm::dvec3& point);

/// Captures the object with one ray through the middle of each texel.
BakeMaster arrows_master(BakeLayout layout, int grid, int tile, const RollRule& roll);

}  // namespace mirage
