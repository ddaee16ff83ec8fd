// A meadow with very many simple instances, for extremes of the instance count.

#include <array>
#include <cmath>

#include "server/scene/builtin/plants.h"
#include "server/scene/builtin/scene_parts.h"
#include "server/scene/builtin/terrain.h"
#include "server/scene/builtin/texture_paint.h"

namespace mirage::builtin {
namespace {

constexpr float kSpacing = 1.2f;
constexpr float kFieldLoopRadius = 3;
constexpr float kMargin = 20;  // metres of meadow around the instances

void add_meadow(SceneParts& parts, float half, float depth, std::uint32_t seed) {
  MeshBuilder builder;
  builder.use(parts.add(textured_material(parts.add(paint_mottle(seed, 0.6f, 12)), 1)));
  add_terrain(
      builder, half, 96, 5, [](float, float) { return 0.0f; },
      [&](glm::vec3 p, glm::vec3) {
        const float patch = fractal_noise(glm::vec2(p.x, p.z) * 0.06f + 300.0f, seed);
        return glm::mix(glm::vec3(0.10f, 0.17f, 0.035f), glm::vec3(0.22f, 0.27f, 0.07f), patch);
      });
  parts.put(parts.add("meadow", builder.take()), {0, 0, -depth});
}

}  // namespace

Scene build_field(const OptionValues& options) {
  const auto count = static_cast<std::uint64_t>(options[0]);
  const auto seed = static_cast<std::uint32_t>(mix_bits(static_cast<std::uint64_t>(options[1])));
  SceneParts parts;
  const PlantMaterials m = add_plant_materials(parts, seed);
  const std::array<std::uint32_t, 5> kinds = {
      parts.add("rock", grow_rock(m, seed, 14)), parts.add("mushroom", grow_mushroom(m, seed)),
      parts.add("flower", grow_flower(m, seed, {0.7f, 0.12f, 0.2f})),
      parts.add("bush", grow_bush(m, seed, 260)),
      parts.add("grass", grow_grass(m, seed, 0.6f, 60))};
  // A square of columns x columns cells that starts in front of the loop and runs to -z.
  const auto columns = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  const float side = kSpacing * static_cast<float>(columns);
  add_meadow(parts, 0.5f * side + kMargin, 0.5f * side, seed);
  Random random(seed, 51);
  parts.scene.instances.reserve(count + 1);
  for (std::uint64_t i = 0; i < count; ++i) {
    const float x = (static_cast<float>(i % columns) + 0.5f) * kSpacing - 0.5f * side;
    const std::uint64_t row = i / columns;
    const float z = -(static_cast<float>(row) + 0.5f) * kSpacing;
    const float pick = random.unit();
    const std::size_t kind = pick < 0.5f    ? 4
                             : pick < 0.72f ? 2
                             : pick < 0.84f ? 3
                             : pick < 0.94f ? 0
                                            : 1;
    const float dx = random.range(-0.4f, 0.4f);
    const float dz = random.range(-0.4f, 0.4f);
    const float yaw = random.angle();
    parts.put(kinds[kind], {x + dx, 0, z + dz}, yaw, random.range(0.7f, 1.3f));
  }
  parts.scene.lighting.ambient = {0.38f, 0.42f, 0.46f};
  parts.scene.lighting.lights = {sun_light({0.7f, 0.9f, 0.5f}, {1.9f, 1.75f, 1.45f})};
  parts.scene.environment = {{0.14f, 0.30f, 0.64f}, {0.62f, 0.74f, 0.86f}, {0.13f, 0.15f, 0.07f}};
  // The loop's far point keeps 1.5 m from the first row.
  parts.scene.home =
      home_on_loop({kFieldLoopRadius, 0, kFieldLoopRadius + 1.5}, kFieldLoopRadius, 1.7, 0, 1.4);
  return std::move(parts.scene);
}

}  // namespace mirage::builtin
