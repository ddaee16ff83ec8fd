#pragma once
// Lighting state of one object: the scene's lights in object space, made canonical so that equal
// light gives an equal key and an equal picture.

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

/// What a tile's shading depends on. `lights` is sorted, quantised, free of lights that add
/// nothing.
struct ObjectLighting {
  glm::vec3 ambient{0};
  std::vector<ObjectLight> lights;
  ProbeLight probe;  ///< turned as the object sees it

  /// What it is, as values in a fixed order: equal for lightings that shade equally.
  std::vector<float> canonical() const;
  /// 64-bit hash of these.
  std::uint64_t hash() const;
};

/// Checks a lighting state from outside: finite, non-negative colours, unit directions (made unit),
/// at most limits::kMaxLights lights, a probe that is turned and not stretched. Error kWireValue
/// names the light.
Result<Lighting> checked_lighting(Lighting lighting);

/// Equal in every value.
bool same_lighting(const Lighting& a, const Lighting& b);

/// A lighting as it stands in the world, as values in a fixed order, without its black lights.
std::vector<double> canonical_values(const Lighting& lighting);

/// 64-bit hash of these; of a lighting as it stands in the world: a shadow tile is
/// made for one place, where what the object sees is not enough.
std::uint64_t lighting_hash(const Lighting& lighting);

/// The scene's lighting as the object of `instance` sees it. Black lights and lights whose range
/// or cone does not reach the bounding sphere (centre, radius in object space) are left out;
/// directions and the probe's rotation are quantised to 1/4096, positions to radius/256, so small
/// motions keep the key; the values used for shading are the quantised ones.
ObjectLighting object_lighting(const Lighting& lighting, const Similarity& world_from_object,
                               const glm::vec3& center, float radius);

/// The same with every light of it, also those that add nothing: what object_lighting() leaves out
/// is what the two differ in.
ObjectLighting whole_object_lighting(const Lighting& lighting, const Similarity& world_from_object,
                                     float radius);

}  // namespace mirage
