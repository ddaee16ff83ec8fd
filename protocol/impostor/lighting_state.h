#pragma once
// Lighting state of one object: the scene's lights in object space, in canonical form, so that
// equal light gives an equal key and an equal picture.

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/model/scene_types.h"

namespace mirage {

/// One light in object space (lengths in object units, already divided by the instance's scale).
struct ObjectLight {
  LightKind kind = LightKind::kDirectional;
  glm::vec3 color{0};      ///< linear, at unit falloff in object units
  glm::vec3 position{0};   ///< point and spot
  glm::vec3 direction{0};  ///< unit; directional and spot, the way the light travels
  float range = 0;         ///< object units; 0: unlimited
  float cos_inner = 1;
  float cos_outer = 0;
};

/// The light that a tile's shading depends on. `lights` is sorted, quantised, and free of lights
/// that add nothing.
struct ObjectLighting {
  glm::vec3 ambient{0};
  std::vector<ObjectLight> lights;
  ProbeLight probe;  ///< turned into object space

  /// Returns the values in a fixed order. Lightings that shade equally give equal values.
  std::vector<float> canonical() const;
  /// Returns a 64-bit hash of canonical().
  std::uint64_t hash() const;
};

/// Checks a lighting state from outside: colours finite and non-negative, directions unit (they are
/// normalised), at most limits::kMaxLights lights, a probe with a pure rotation. Error kWireValue
/// names the light.
Result<Lighting> checked_lighting(Lighting lighting);

/// True if all values are equal.
bool same_lighting(const Lighting& a, const Lighting& b);

/// Returns a lighting in world space as values in a fixed order, without its black lights.
std::vector<double> canonical_values(const Lighting& lighting);

/// Returns a 64-bit hash of canonical_values(). Shadow tiles use it: each is made for one place in
/// the world, so light in object space is not enough.
std::uint64_t lighting_hash(const Lighting& lighting);

/// Returns the scene's lighting as the object of `instance` sees it. Black lights, and lights whose
/// range or cone misses the bounding sphere (centre, radius in object space), are left out.
/// Directions and the probe's rotation are quantised to 1/4096, positions to radius/256, so that
/// small motions keep the key. Shading uses the quantised values.
ObjectLighting object_lighting(const Lighting& lighting, const Similarity& world_from_object,
                               const glm::vec3& center, float radius);

/// Returns the lighting with every light, including those that add nothing. Comparing it with
/// object_lighting() shows what that leaves out.
ObjectLighting whole_object_lighting(const Lighting& lighting, const Similarity& world_from_object,
                                     float radius);

}  // namespace mirage
