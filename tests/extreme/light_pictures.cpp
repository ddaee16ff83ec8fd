#include "tests/extreme/light_pictures.h"

#include <algorithm>

#include "client/draw/frame_target.h"
#include "server/render/gpu_scene.h"
#include "server/scene/gltf/gltf_import.h"
#include "tests/extreme/shapes.h"

namespace mirage::extreme {

Result<std::unique_ptr<Studio>> ball_studio(const Conditions& conditions, float metallic,
                                            const char* alpha_mode) {
  test::Builder builder = document(dented_ball());
  set_material(builder, {{"alphaMode", alpha_mode},
                         {"pbrMetallicRoughness",
                          {{"baseColorFactor", {0.7, 0.5, 0.3, 0.6}},
                           {"metallicFactor", metallic},
                           {"roughnessFactor", 0.4}}}});
  Result<Scene> scene = import_gltf(write(builder, conditions.folder, "ball"));
  if (!scene) return scene.error();
  scene->environment.zenith = scene->environment.horizon = scene->environment.nadir = glm::vec3(0);
  return Studio::create(scene.take());
}

Light point_light(const glm::dvec3& position, float intensity) {
  Light light;
  light.kind = LightKind::kPoint;
  light.position = position;
  light.color = glm::vec3(intensity);
  return light;
}

Light sun(float intensity, const glm::vec3& towards) {
  Light light;
  light.color = glm::vec3(intensity);
  light.direction = glm::normalize(towards);
  return light;
}

Light spot(float intensity) {
  Light light = point_light({1, 2, 3}, intensity);
  light.kind = LightKind::kSpot;
  light.direction = glm::normalize(glm::vec3(-1, -2, -3));
  light.cos_inner = 0.97f;
  light.cos_outer = 0.9f;
  return light;
}

Lighting only(float ambient, std::vector<Light> lights) {
  Lighting out;
  out.ambient = glm::vec3(ambient);
  out.lights = std::move(lights);
  return out;
}

Shots shoot(Studio& studio, const Lighting& light) {
  studio.set_light(light);
  const Camera camera = studio.camera(0, {0.5, 0.4, 1}, 4, kLightPictureEdge);
  return {studio.truth(camera).rgba, studio.meshes(camera),
          studio.impostors(camera, DrawMethod::kDepth),
          studio.impostors(camera, DrawMethod::kDepth, kRelitTile)};
}

int brightest(const Pixels& p) {
  int most = 0;
  for (std::size_t i = 0; i < p.size(); i += 4) {
    if (p[i + 3] != 255) continue;
    for (std::size_t c = 0; c < 3; ++c) most = std::max<int>(most, p[i + c]);
  }
  return most;
}

int darker(const Pixels& a, const Pixels& b, int by) {
  int n = 0;
  for (std::size_t i = 0; i < a.size(); i += 4) {
    if (a[i + 3] != 255 || b[i + 3] != 255) continue;
    for (std::size_t c = 0; c < 3; ++c) n += b[i + c] + by < a[i + c] ? 1 : 0;
  }
  return n;
}

}  // namespace mirage::extreme
