#pragma once
// Building blocks of all built-in scenes, and the list of their builders.

#include <string>
#include <utility>

#include "server/base/load_tools.h"
#include "server/scene/builtin/mesh_builder.h"
#include "server/scene/builtin/options.h"
#include "server/scene/builtin/random.h"
#include "server/scene/scene.h"

namespace mirage::builtin {

/// A scene under construction.
struct SceneParts {
  Scene scene;

  std::uint32_t add(Material material);
  std::int32_t add(Image image);
  std::uint32_t add(std::string name, Mesh mesh);
  void put(std::uint32_t object, glm::dvec3 position, float yaw = 0, float scale = 1);
};

/// Returns a dielectric or metal with colours from the vertices.
Material painted_material(float roughness, float metallic = 0);
/// Returns a painted material multiplied by an image; `image` is an index into Scene::images.
Material textured_material(std::int32_t image, float roughness);
/// Returns an alpha-masked, double-sided card.
Material card_material(std::int32_t image, float roughness = 0.85f);
/// Returns a black material that emits `radiance`, independent of vertex colours.
Material glowing_material(glm::vec3 radiance);

glm::quat yaw_rotation(float yaw);
/// Returns a light that travels along -toward_sun.
Light sun_light(glm::vec3 toward_sun, glm::vec3 color);
/// Returns eye and target such that the walk loop (turning right) is the circle about `center`.
HomeView home_on_loop(glm::dvec3 center, double radius_m, double eye_height_m, double yaw,
                      double speed_mps);

Scene build_forest(const OptionValues& options);
Scene build_clutter(const OptionValues& options);
Scene build_city(const OptionValues& options);
Scene build_museum(const OptionValues& options, const LoadTools& tools);
Scene build_knot(const OptionValues& options);
Scene build_field(const OptionValues& options);

}  // namespace mirage::builtin
