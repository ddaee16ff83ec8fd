#include "server/scene/builtin/scene_parts.h"

#include <cmath>

namespace mirage::builtin {

std::uint32_t SceneParts::add(Material material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

std::int32_t SceneParts::add(Image image) {
  scene.images.push_back(std::move(image));
  return static_cast<std::int32_t>(scene.images.size() - 1);
}

std::uint32_t SceneParts::add(std::string name, Mesh mesh) {
  scene.objects.push_back({std::move(name), std::move(mesh)});
  return static_cast<std::uint32_t>(scene.objects.size() - 1);
}

void SceneParts::put(std::uint32_t object, glm::dvec3 position, float yaw, float scale) {
  scene.instances.push_back({object, {position, yaw_rotation(yaw), scale}});
}

Material painted_material(float roughness, float metallic) {
  Material m;
  m.metallic = metallic;
  m.roughness = roughness;
  return m;
}

Material textured_material(std::int32_t image, float roughness) {
  Material m = painted_material(roughness);
  m.base_color_map.image = image;
  return m;
}

Material card_material(std::int32_t image, float roughness) {
  Material m = textured_material(image, roughness);
  m.alpha_mode = AlphaMode::kMask;
  m.double_sided = true;
  m.base_color_map.wrap_s = Wrap::kClamp;
  m.base_color_map.wrap_t = Wrap::kClamp;
  return m;
}

Material glowing_material(glm::vec3 radiance) {
  Material m = painted_material(1);
  m.base_color = {0, 0, 0, 1};
  m.emissive = radiance;
  return m;
}

glm::quat yaw_rotation(float yaw) { return {std::cos(yaw * 0.5f), 0, std::sin(yaw * 0.5f), 0}; }

Light sun_light(glm::vec3 toward_sun, glm::vec3 color) {
  Light light;
  light.color = color;
  light.direction = -glm::normalize(toward_sun);
  return light;
}

HomeView home_on_loop(glm::dvec3 center, double radius_m, double eye_height_m, double yaw,
                      double speed_mps) {
  const glm::dvec3 forward(std::sin(yaw), 0, -std::cos(yaw));
  const glm::dvec3 right(std::cos(yaw), 0, std::sin(yaw));
  HomeView home;
  home.eye = center - right * radius_m + glm::dvec3(0, eye_height_m, 0);
  home.target = home.eye + forward;
  home.walk_radius_m = radius_m;
  home.walk_speed_mps = speed_mps;
  return home;
}

}  // namespace mirage::builtin
