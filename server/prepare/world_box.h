#pragma once
// The box of an instance along the world's axes.

#include <glm/glm.hpp>

#include "protocol/impostor/object_proxy.h"
#include "protocol/model/scene_types.h"

namespace mirage {

/// Metres.
struct WorldBox {
  glm::dvec3 low{0}, high{0};
};

/// Returns the smallest box along the world's axes around the instance's turned box.
inline WorldBox world_box(const Instance& instance, const ObjectDescription& object) {
  const Similarity& m = instance.world_from_object;
  const glm::dmat3 turn = glm::mat3_cast(glm::dquat(m.rotation)) * double{m.scale};
  const glm::dvec3 middle = 0.5 * (glm::dvec3(object.box_min) + glm::dvec3(object.box_max));
  const glm::dvec3 half = 0.5 * (glm::dvec3(object.box_max) - glm::dvec3(object.box_min));
  const glm::dvec3 at = m.position + turn * middle;
  const glm::dvec3 reach =
      glm::abs(turn[0]) * half.x + glm::abs(turn[1]) * half.y + glm::abs(turn[2]) * half.z;
  return {at - reach, at + reach};
}

}  // namespace mirage
