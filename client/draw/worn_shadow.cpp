#include "client/draw/worn_shadow.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

#include "client/hold/shadow_cache.h"
#include "client/hold/tile_cache.h"
#include "protocol/impostor/sun_frame.h"

namespace mirage {

WornShadow worn_shadow(const DrawnImpostor& drawn, const glm::quat& space) {
  WornShadow out;
  if (!drawn.shadow) return out;
  const ShadowRecord& tile = *drawn.shadow;
  const Capture& capture = tile.capture;
  const glm::dmat3 axes(capture.basis.right, capture.basis.up, -capture.basis.forward);
  const glm::quat turn = space * glm::quat(glm::quat_cast(axes));
  const double half = 0.5 * capture.edge;
  out.rotation = {turn.x, turn.y, turn.z, turn.w};
  out.view = {capture.distance, half / capture.half_tangent, tile.slot.x + 1 + half - tile.crop.x,
              tile.slot.y + 1 + half - tile.crop.y};
  out.place = {tile.slot.x + 1, tile.slot.y + 1, tile.crop.w + 4096.0 * tile.crop.h,
               tile.slot.layer};
  return out;
}

glm::vec3 shadow_tint(const Lighting& lighting) {
  const Light* sun = sun_of(lighting);
  if (!sun) return glm::vec3(1);
  constexpr float kCosine = 0.5f;
  const auto share = [&](float light, float ambient) {
    return light / std::max(ambient + kCosine * light, 1e-6f);
  };
  const glm::vec3 weights(0.2126f, 0.7152f, 0.0722f);
  const float whole = share(glm::dot(sun->color, weights), glm::dot(lighting.ambient, weights));
  glm::vec3 tint;
  for (int c = 0; c < 3; ++c) tint[c] = share(sun->color[c], lighting.ambient[c]) / whole;
  return tint;
}

}  // namespace mirage
