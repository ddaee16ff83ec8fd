#include "server/prove/proof_cases.h"

#include <algorithm>

#include "protocol/base/limits.h"
#include "protocol/impostor/tile_key.h"
#include "protocol/model/model.h"
#include "protocol/model/scene_types.h"
#include "server/prepare/derived_cache.h"
#include "server/prepare/prepared_scene.h"

namespace mirage {

std::vector<glm::dvec3> proof_directions(int count) {
  std::vector<glm::dvec3> out;
  for (const int zeros : {2, 0, 1}) {
    for (int i = 0; i < 27; ++i) {
      const glm::ivec3 v(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      if ((v.x == 0) + (v.y == 0) + (v.z == 0) == zeros) out.emplace_back(v);
    }
  }
  out.resize(static_cast<std::size_t>(std::clamp(count, 1, 26)));
  return out;
}

std::vector<ProofLighting> proof_lighting(const PreparedScene& scene) {
  const Lighting& own = scene.scene.lighting;
  Lighting off = own, turned = own;
  for (int i = 0; i < 3 && off.lights.size() < limits::kMaxLights; ++i) {
    Light lamp;
    lamp.kind = LightKind::kPoint;
    lamp.color = glm::vec3(0);
    lamp.position = scene.bounds_center + glm::dvec3(i - 1, 2, 1) * scene.bounds_radius;
    off.lights.push_back(lamp);
  }
  for (Light& light : turned.lights) {
    light.direction =
        glm::normalize(glm::vec3(-light.direction.z, light.direction.y - 0.2f, light.direction.x));
  }
  if (turned.lights.size() < limits::kMaxLights) {
    Light lamp;
    lamp.kind = LightKind::kPoint;
    lamp.position = scene.bounds_center + glm::dvec3(0, 3 * scene.bounds_radius, 0);
    lamp.range = static_cast<float>(scene.bounds_radius);
    turned.lights.push_back(lamp);
  }
  return {{"as the scene has it", own},
          {"with three lamps off", off},
          {"turned, a lamp out of reach", turned}};
}

std::shared_ptr<const PreparedScene> as_imported(const PreparedScene& scene) {
  auto out = std::make_shared<PreparedScene>(scene);
  out->scene.materials = scene.imported->materials;
  out->scene.images = scene.imported->images;
  for (std::size_t i = 0; i < out->scene.materials.size(); ++i) {
    Material& m = out->scene.materials[i];
    const bool solid = scene.scene.materials[i].alpha_mode == AlphaMode::kOpaque;
    if (solid && m.alpha_mode == AlphaMode::kBlend) m.alpha_mode = AlphaMode::kOpaque;
  }
  out->mips = make_mips(out->scene);
  return out;
}

}  // namespace mirage
