#pragma once
// The sun's view of a scene. Shadow maps are drawn and read with it, at both ends.

#include <glm/glm.hpp>

#include "protocol/model/scene_types.h"

namespace mirage {

/// Returns the light that casts shadows: the directional light with the largest luminance, the
/// first of equals; nullptr if there is none.
const Light* sun_of(const Lighting& lighting);

/// Orthographic view of a sphere along the light, `edge` texels a side. It depends on nothing else,
/// so every camera uses the same map.
struct SunFrame {
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0};  ///< world, unit
  glm::dvec3 forward{0, 0, -1};            ///< direction in which the light travels
  glm::dvec3 center{0};                    ///< world, m
  double radius = 1;                       ///< m
  int edge = 1;

  SunFrame() = default;
  SunFrame(const glm::vec3& direction, const glm::dvec3& center, double radius, int edge);

  double texel_m() const { return 2 * radius / edge; }
  /// Returns the matrix from positions relative to `eye` (world axes, m) to clip space, for drawing
  /// casters.
  glm::mat4 clip_from_relative(const glm::dvec3& eye) const;
  /// Returns the matrix from such positions to 0..1 in all three axes, for reading the map.
  glm::mat4 map_from_relative(const glm::dvec3& eye) const;
};

/// Texels a side of a shadow map. Its depth has 16 bits, which is a sixteenth of a texel in any
/// scene.
inline constexpr int kShadowMapEdge = 4096;

}  // namespace mirage
