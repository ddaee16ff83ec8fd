// Blocks of buildings in a grid of streets. The home view is where a street meets a plaza.

#include <algorithm>
#include <array>
#include <cmath>

#include "server/scene/builtin/buildings.h"
#include "server/scene/builtin/texture_paint.h"

namespace mirage::builtin {
namespace {

constexpr float kBlock = 40;
constexpr float kStreet = 12;
constexpr float kPitch = kBlock + kStreet;
constexpr float kCityLoopRadius = 6;
constexpr float kCityFreeRadius = 10;  // metres about the loop's centre that stay empty

struct Plan {
  int blocks;
  int plaza_column;
  int plaza_row;
  glm::vec2 loop;  ///< centre of the walk loop

  explicit Plan(int count) : blocks(count) {
    plaza_column = count / 2;
    // Most of the city lies ahead (-z); a single block gets the plaza before it.
    plaza_row = count == 1 ? 1 : (2 * count) / 3;
    loop = center(plaza_column, plaza_row) + glm::vec2(kCityLoopRadius - 0.5f * kPitch, 0);
  }
  glm::vec2 center(int column, int row) const {
    const float middle = 0.5f * static_cast<float>(blocks - 1);
    return glm::vec2(static_cast<float>(column) - middle, static_cast<float>(row) - middle) *
           kPitch;
  }
  bool plaza(int column, int row) const { return column == plaza_column && row == plaza_row; }
  bool free(glm::vec2 p) const { return glm::length(p - loop) > kCityFreeRadius; }
};

struct Kit {
  std::array<std::uint32_t, kBuildingKinds> buildings{};
  std::array<std::uint32_t, 5> cars{};
  std::array<std::uint32_t, 2> trees{};
  std::uint32_t lamp = 0;
  std::uint32_t bench = 0;
  std::uint32_t bin = 0;
};

Kit add_kit(SceneParts& parts, const CityMaterials& m, std::uint32_t seed) {
  Kit kit;
  for (int i = 0; i < kBuildingKinds; ++i) {
    kit.buildings[static_cast<std::size_t>(i)] =
        parts.add(building_name(i), make_building(m, i, seed + static_cast<std::uint32_t>(i)));
  }
  kit.cars = {parts.add("red car", make_car(m, {0.45f, 0.03f, 0.025f}, false)),
              parts.add("blue car", make_car(m, {0.03f, 0.1f, 0.3f}, false)),
              parts.add("silver car", make_car(m, {0.45f, 0.46f, 0.48f}, false)),
              parts.add("black car", make_car(m, {0.02f, 0.02f, 0.022f}, false)),
              parts.add("white van", make_car(m, {0.68f, 0.67f, 0.63f}, true))};
  kit.trees = {parts.add("street tree", make_street_tree(m, seed)),
               parts.add("street tree", make_street_tree(m, seed + 1))};
  kit.lamp = parts.add("street lamp", make_street_lamp(m));
  kit.bench = parts.add("bench", make_bench(m));
  kit.bin = parts.add("bin", make_bin(m));
  return kit;
}

void add_ground(SceneParts& parts, const Plan& plan, std::uint32_t seed) {
  MeshBuilder b;
  b.use(parts.add(textured_material(parts.add(paint_mottle(seed + 5, 0.5f, 16)), 0.95f)));
  const float half = 0.5f * kPitch * static_cast<float>(plan.blocks + 2);
  const int cells = glm::min(64, 8 * (plan.blocks + 2));
  b.paint(glm::vec3(0.1f));
  b.grid_face({-half, 0, half}, {half, 0, half}, {-half, 0, -half}, cells, cells,
              glm::vec2(half / 3));
  const int rows = std::max(plan.blocks, plan.plaza_row + 1);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < plan.blocks; ++column) {
      const glm::vec2 c = plan.center(column, row);
      const bool plaza = plan.plaza(column, row);
      const float h = 0.5f * kBlock;
      const float top = plaza ? 0.02f : 0.14f;
      b.paint(plaza ? glm::vec3(0.36f, 0.30f, 0.24f) : glm::vec3(0.30f, 0.295f, 0.28f));
      b.grid_face({c.x - h, top, c.y + h}, {c.x + h, top, c.y + h}, {c.x - h, top, c.y - h}, 4, 4,
                  {10, 10});
      b.paint(glm::vec3(0.22f));
      b.box({c.x - h - 0.2f, -0.05f, c.y - h - 0.2f},
            {c.x + h + 0.2f, top - 0.01f, c.y + h + 0.2f});
      // Dashes down the streets to the left of and behind each block.
      b.paint(glm::vec3(0.55f));
      for (int i = 0; i < 7; ++i) {
        const float t = -h + 2.5f + 5.6f * static_cast<float>(i);
        const float x = c.x - 0.5f * kPitch;
        const float z = c.y - 0.5f * kPitch;
        b.box({x - 0.07f, -0.02f, c.y + t}, {x + 0.07f, 0.012f, c.y + t + 2.4f});
        b.box({c.x + t, -0.02f, z - 0.07f}, {c.x + t + 2.4f, 0.012f, z + 0.07f});
      }
      // A zebra crossing at the corner.
      for (int i = 0; i < 9; ++i) {
        const float x = c.x - 0.5f * kPitch - 4.9f + 1.15f * static_cast<float>(i);
        b.box({x, -0.02f, c.y - h - 0.2f}, {x + 0.6f, 0.013f, c.y - h + 2.4f});
      }
    }
  }
  parts.put(parts.add("ground", b.take()), {0, 0, 0});
}

void add_buildings(SceneParts& parts, const Kit& kit, glm::vec2 c, float downtown, Random& random) {
  for (int lot = 0; lot < 4; ++lot) {
    const float sx = lot % 2 == 0 ? -1.0f : 1.0f;
    const float sz = lot < 2 ? -1.0f : 1.0f;
    const glm::vec2 p = c + glm::vec2(sx, sz) * (0.5f * kLot + 0.25f);
    constexpr std::array<std::uint32_t, 5> kTall = {2, 3, 4, 6, 8};
    constexpr std::array<std::uint32_t, 5> kLow = {0, 1, 5, 7, 6};
    const std::uint32_t pick = random.index(5);
    const std::uint32_t kind = random.chance(downtown) ? kTall[pick] : kLow[pick];
    const float turn = 1.5707963f * static_cast<float>(random.index(4));
    parts.put(kit.buildings[kind], {p.x, 0.14f, p.y}, turn);
  }
}

/// Trees, lamps, benches and parked cars along the four sides of a block.
void add_kerb(SceneParts& parts, const Kit& kit, const Plan& plan, glm::vec2 c, float ground,
              Random& random) {
  const float kerb = 0.5f * kBlock - 0.7f;
  for (int side = 0; side < 4; ++side) {
    const float yaw = 1.5707963f * static_cast<float>(side);
    const glm::vec2 out(std::sin(yaw), std::cos(yaw));
    const glm::vec2 along(out.y, -out.x);
    const auto put = [&](std::uint32_t object, float t, float off, float y, float turn,
                         float scale) {
      const glm::vec2 p = c + along * t + out * off;
      if (plan.free(p)) parts.put(object, {p.x, y, p.y}, yaw + turn, scale);
    };
    for (int i = 0; i < 4; ++i) {
      const float t = -15 + 10 * static_cast<float>(i);
      const float size = random.range(0.85f, 1.2f);
      const std::uint32_t tree = kit.trees[random.index(2)];
      put(i % 2 == 0 ? tree : kit.lamp, t, kerb, ground, 0, i % 2 == 0 ? size : 1.0f);
      if (random.chance(0.35f)) put(kit.bench, t + 3, kerb - 0.2f, ground, 3.14159f, 1);
      if (random.chance(0.25f)) put(kit.bin, t + 5.2f, kerb, ground, 0, 1);
    }
    for (int i = 0; i < 5; ++i) {
      if (!random.chance(0.55f)) continue;
      const float t = -14 + 6.6f * static_cast<float>(i) + random.range(-0.5f, 0.5f);
      const std::uint32_t car = kit.cars[random.index(5)];
      const float flip = random.chance(0.5f) ? 0.0f : 3.14159f;
      put(car, t, 0.5f * kBlock + 1.35f, 0, 1.5707963f + flip, 1);
    }
  }
}

}  // namespace

Scene build_city(const OptionValues& options) {
  const int blocks = static_cast<int>(options[0]);
  const auto seed = static_cast<std::uint32_t>(mix_bits(static_cast<std::uint64_t>(options[1])));
  SceneParts parts;
  const CityMaterials m = add_city_materials(parts, seed);
  const Kit kit = add_kit(parts, m, seed);
  const Plan plan(blocks);
  add_ground(parts, plan, seed);
  Random random(seed, 73);
  const int rows = std::max(blocks, plan.plaza_row + 1);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < blocks; ++column) {
      const glm::vec2 c = plan.center(column, row);
      const bool plaza = plan.plaza(column, row);
      const float far = glm::length(c) / (kPitch * static_cast<float>(blocks));
      if (!plaza) add_buildings(parts, kit, c, 0.85f - 0.9f * far, random);
      add_kerb(parts, kit, plan, c, plaza ? 0.02f : 0.14f, random);
    }
  }
  parts.scene.lighting.ambient = {0.36f, 0.40f, 0.46f};
  parts.scene.lighting.lights = {sun_light({0.6f, 0.75f, 0.55f}, {1.8f, 1.68f, 1.42f})};
  parts.scene.environment = {{0.14f, 0.30f, 0.64f}, {0.62f, 0.74f, 0.86f}, {0.12f, 0.12f, 0.12f}};
  parts.scene.environment.fog_density = static_cast<float>(options[2]);
  parts.scene.home = home_on_loop({plan.loop.x, 0, plan.loop.y}, kCityLoopRadius, 1.7, 0, 1.4);
  return std::move(parts.scene);
}

}  // namespace mirage::builtin
