#pragma once
// The sun's own view of a scene: what a shadow map is drawn and read with. Both ends use it.

#include <glm/glm.hpp>

#include "protocol/model/scene_types.h"

namespace mirage {

/// The light that casts shadows: the strongest directional one (luminance), of equals the first;
/// nullptr when there is none.
const Light* sun_of(const Lighting& lighting);

/// Orthographic view along the light of a sphere, `edge` texels a side. It depends on nothing else,
/// so a map of it is the same for every camera.
struct SunFrame {
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0};  ///< world, unit
  glm::dvec3 forward{0, 0, -1};            ///< the way the light travels
  glm::dvec3 center{0};                    ///< world, m
  double radius = 1;                       ///< m
  int edge = 1;

  SunFrame() = default;
  SunFrame(const glm::vec3& direction, const glm::dvec3& center, double radius, int edge);

  double texel_m() const { return 2 * radius / edge; }
  /// From positions relative to `eye` (world axes, m) to clip space, for drawing casters.
  glm::mat4 clip_from_relative(const glm::dvec3& eye) const;
  /// The same to 0..1 in all three axes, for reading the map.
  glm::mat4 map_from_relative(const glm::dvec3& eye) const;
};

/// Texels a side of a shadow map. Its depth is 16 bits: a sixteenth of a texel, whatever the scene.
inline constexpr int kShadowMapEdge = 4096;

}  // namespace mirage
