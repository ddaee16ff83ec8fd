// A walk through a forest: a circular path, a pond, hills around.

#include <algorithm>
#include <array>
#include <cmath>

#include "server/scene/builtin/plants.h"
#include "server/scene/builtin/scene_parts.h"
#include "server/scene/builtin/terrain.h"
#include "server/scene/builtin/texture_paint.h"
#include "server/scene/builtin/tree_builder.h"

namespace mirage::builtin {
namespace {

constexpr float kForestLoopRadius = 20;  // the walk loop is the circle about the origin
constexpr float kPlainHalf = 80;         // half side of the terrain for up to 400 trees
constexpr float kWaterLevel = -0.55f;
constexpr glm::vec2 kPondCenter{-19, -33};
constexpr glm::vec2 kPondRadii{13, 10};
constexpr float kTrunkClearance = 3.5f;

struct Tree {
  glm::vec2 position;
  float crown_radius;
  float clearance;  ///< least distance of the trunk from the walk loop
  float scale;
  std::uint32_t species;
};

class Layout {
 public:
  Layout(int trees, std::uint32_t seed) : seed_(seed) {
    half_ = kPlainHalf * std::max(1.0f, std::sqrt(static_cast<float>(trees) / 400.0f));
    columns_ = static_cast<int>(2 * half_ / kCell) + 1;
    cells_.resize(static_cast<std::size_t>(columns_ * columns_));
  }

  float half() const { return half_; }
  const std::vector<Tree>& trees() const { return trees_; }

  static float distance_to_loop(glm::vec2 p) {
    return std::abs(glm::length(p) - kForestLoopRadius);
  }

  /// 1 on the shore, less in the pond.
  float pond_depth(glm::vec2 p) const {
    const glm::vec2 d = (p - kPondCenter) / kPondRadii;
    return glm::length(d) * (0.9f + 0.2f * value_noise(d * 2.0f + 50.0f, seed_));
  }

  float height(float x, float z) const {
    const glm::vec2 p(x, z);
    const float r = glm::length(p);
    const float rolling = 1.3f * fractal_noise(p * 0.045f + 100.0f, seed_);
    const float hill = glm::smoothstep(38.0f, kPlainHalf + 15, r) *
                       (7.0f + 9.0f * fractal_noise(p * 0.02f + 40.0f, seed_ + 5));
    const float land = glm::smoothstep(6.0f, 16.0f, distance_to_loop(p)) * (rolling + hill);
    return glm::mix(-1.5f, land, glm::smoothstep(0.72f, 1.3f, pond_depth(p)));
  }

  template <typename F>
  void each_near(glm::vec2 p, F f) const {
    const int cx = column(p.x);
    const int cz = column(p.y);
    for (int z = std::max(0, cz - 1); z <= std::min(columns_ - 1, cz + 1); ++z) {
      for (int x = std::max(0, cx - 1); x <= std::min(columns_ - 1, cx + 1); ++x) {
        for (const std::uint32_t i : cells_[static_cast<std::size_t>(z * columns_ + x)]) {
          f(trees_[i]);
        }
      }
    }
  }

  void plant(int count, int species);

 private:
  static constexpr float kCell = 9;  // larger than the distance kept between any two crowns

  int column(float v) const {
    return glm::clamp(static_cast<int>((v + half_) / kCell), 0, columns_ - 1);
  }
  bool free_for(const Tree& tree, float closeness) const;

  std::uint32_t seed_;
  float half_;
  int columns_;
  std::vector<Tree> trees_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

bool Layout::free_for(const Tree& tree, float closeness) const {
  const glm::vec2 p = tree.position;
  if (distance_to_loop(p) < tree.clearance || pond_depth(p) < 1.4f) return false;
  // The view from home to the pond stays open.
  const float along = -p.y / 33.0f;
  if (along > 0 && along < 1 && std::abs(p.x + kForestLoopRadius) < 3 + 6 * along) return false;
  bool free = true;
  each_near(p, [&](const Tree& other) {
    const float apart = closeness * (tree.crown_radius + other.crown_radius);
    free = free && glm::length(other.position - p) >= std::max(1.2f, apart);
  });
  return free;
}

void Layout::plant(int count, int species) {
  Random random(seed_, 41);
  // Few trees gather round the walk instead of losing themselves on the plain.
  const float reach = std::min(half_ - 3, 24 + 4.0f * std::sqrt(static_cast<float>(count)));
  const auto kinds = static_cast<std::uint32_t>(species);
  int misses = 0;
  while (trees_.size() < static_cast<std::size_t>(count)) {
    Tree tree;
    tree.position.x = random.range(-reach, reach);
    tree.position.y = random.range(-reach, reach);
    tree.scale = random.range(0.75f, 1.25f);
    // Kinds grow in stands, with some other trees among them.
    const float stand = 2.2f * fractal_noise(tree.position * 0.035f + 70.0f, seed_ + 8) - 0.6f;
    tree.species = random.chance(0.4f)
                       ? random.index(kinds)
                       : static_cast<std::uint32_t>(glm::clamp(stand, 0.0f, 0.999f) *
                                                    static_cast<float>(kinds));
    const TreeSpecies& kind = tree_species(static_cast<int>(tree.species));
    tree.crown_radius = kind.crown_radius * tree.scale;
    // A walker passes under high crowns but not through low ones.
    const float reach_low = kind.crown_base < 2 ? 1.15f * kind.crown_radius + kind.card + 0.3f
                                                : 0.75f * kind.crown_radius;
    tree.clearance = std::max(kTrunkClearance, reach_low * tree.scale);
    const float closeness = 0.7f * std::pow(0.97f, static_cast<float>(misses) / 40.0f);
    if (!free_for(tree, closeness)) {
      ++misses;
      continue;
    }
    misses = std::max(0, misses - 10);
    const int cell = column(tree.position.y) * columns_ + column(tree.position.x);
    cells_[static_cast<std::size_t>(cell)].push_back(static_cast<std::uint32_t>(trees_.size()));
    trees_.push_back(tree);
  }
}

glm::vec3 ground_color(const Layout& layout, glm::vec3 p, glm::vec3 normal, std::uint32_t seed) {
  const glm::vec2 at(p.x, p.z);
  float cover = 0;
  float open = 1;
  layout.each_near(at, [&](const Tree& tree) {
    const float d = glm::length(tree.position - at);
    const float shade = std::exp(-(d * d) / (tree.crown_radius * tree.crown_radius));
    cover += shade;
    open *= 1 - 0.5f * shade - 0.2f * std::exp(-2 * d * d);
  });
  const float patch = fractal_noise(at * 0.16f + 60.0f, seed + 20);
  const glm::vec3 grass =
      glm::mix(glm::vec3(0.085f, 0.15f, 0.028f), glm::vec3(0.19f, 0.24f, 0.06f), patch);
  const glm::vec3 litter =
      glm::mix(glm::vec3(0.10f, 0.068f, 0.035f), glm::vec3(0.17f, 0.11f, 0.05f), patch);
  const glm::vec3 sand(0.32f, 0.27f, 0.18f);
  glm::vec3 c = glm::mix(grass, litter, glm::smoothstep(0.25f, 0.95f, 0.7f * cover + 0.4f * patch));
  c = glm::mix(c, litter, glm::smoothstep(0.9f, 0.75f, normal.y));
  const float wobble = 0.5f * value_noise(at * 0.4f + 10.0f, seed + 30);
  const float path = glm::smoothstep(2.0f, 0.9f, Layout::distance_to_loop(at) + wobble);
  c = glm::mix(c, glm::vec3(0.30f, 0.225f, 0.14f), 0.9f * path);
  c = glm::mix(c, sand, glm::smoothstep(kWaterLevel + 0.35f, kWaterLevel, p.y));
  return c * 1.25f * open * (1 - 0.4f * glm::smoothstep(kWaterLevel, -1.5f, p.y));
}

void add_ground(SceneParts& parts, const Layout& layout, std::uint32_t seed) {
  MeshBuilder builder;
  builder.use(parts.add(textured_material(parts.add(paint_mottle(seed, 0.75f, 12)), 1)));
  const int cells = glm::clamp(static_cast<int>(layout.half() * 1.6f), 128, 512);
  add_terrain(
      builder, layout.half(), cells, 4, [&](float x, float z) { return layout.height(x, z); },
      [&](glm::vec3 p, glm::vec3 n) { return ground_color(layout, p, n, seed); });
  parts.put(parts.add("terrain", builder.take()), {0, 0, 0});
}

void add_water(SceneParts& parts) {
  MeshBuilder builder;
  builder.use(parts.add(painted_material(0.12f, 0.15f)));
  const int rings = 6;
  const int segments = 64;
  for (int j = 0; j <= rings; ++j) {
    const float t = 1.5f * static_cast<float>(j) / static_cast<float>(rings);
    for (int s = 0; s < segments; ++s) {
      const float a = 6.2831853f * static_cast<float>(s) / static_cast<float>(segments);
      const glm::vec3 p(t * kPondRadii.x * std::cos(a), 0, t * kPondRadii.y * std::sin(a));
      // A stand-in for the sky's reflection: brighter at flatter viewing angles.
      const float far = glm::smoothstep(9.0f, -12.0f, p.z);
      builder.paint(glm::mix(glm::vec3(0.07f, 0.13f, 0.15f), glm::vec3(0.26f, 0.38f, 0.47f), far));
      builder.vertex(p, {0, 1, 0}, {p.x, p.z});
    }
  }
  for (std::uint32_t j = 0; j < rings; ++j) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const std::uint32_t k = j * segments + s;
      const std::uint32_t next = j * segments + (s + 1) % segments;
      builder.quad(k, next, next + segments, k + segments);
    }
  }
  parts.put(parts.add("pond", builder.take()), {kPondCenter.x, kWaterLevel, kPondCenter.y});
}

struct Undergrowth {
  std::uint32_t object;
  float radius;
  float weight;
};

void scatter_undergrowth(SceneParts& parts, const Layout& layout, int count, std::uint32_t seed) {
  const PlantMaterials m = add_plant_materials(parts, seed);
  const std::array<Undergrowth, 8> kinds = {{
      {parts.add("grass patch", grow_grass(m, seed, 0.9f, 90)), 1.0f, 0.34f},
      {parts.add("tall grass", grow_grass(m, seed + 1, 0.5f, 50)), 0.6f, 0.16f},
      {parts.add("fern", grow_fern(m, seed)), 0.9f, 0.14f},
      {parts.add("bush", grow_bush(m, seed, 420)), 1.0f, 0.10f},
      {parts.add("rock", grow_rock(m, seed, 20)), 0.6f, 0.09f},
      {parts.add("boulder", grow_rock(m, seed + 2, 24)), 0.6f, 0.05f},
      {parts.add("flower", grow_flower(m, seed, {0.65f, 0.6f, 0.75f})), 0.4f, 0.08f},
      {parts.add("mushroom", grow_mushroom(m, seed)), 0.3f, 0.04f},
  }};
  Random random(seed, 42);
  const float spread = std::max(1.0f, std::sqrt(static_cast<float>(count) / 150.0f));
  for (int i = 0; i < count; ++i) {
    float pick = random.unit();
    std::size_t kind = 0;
    while (kind + 1 < kinds.size() && pick >= kinds[kind].weight) pick -= kinds[kind++].weight;
    const float scale = random.range(0.75f, 1.4f);
    for (int attempt = 0;; ++attempt) {
      const float a = random.angle();
      // Two in three gather along the part of the path seen from home.
      const float angle = i % 3 != 0 ? 3.14159f + 0.2f * a - 0.05f : a;
      const float gap = 1.3f + kinds[kind].radius * scale;
      const float off = gap + 11 * spread * random.unit() * random.unit();
      const float r = kForestLoopRadius + (random.chance(0.5f) && off < 18 ? -off : off);
      const glm::vec2 p(r * std::cos(angle), r * std::sin(angle));
      const bool inside = std::max(std::abs(p.x), std::abs(p.y)) < layout.half() - 1;
      if (attempt < 20 && (!inside || layout.pond_depth(p) < 1.1f)) continue;
      if (!inside) continue;
      parts.put(kinds[kind].object, {p.x, layout.height(p.x, p.y), p.y}, random.angle(), scale);
      break;
    }
  }
}

}  // namespace

Scene build_forest(const OptionValues& options) {
  const int trees = static_cast<int>(options[0]);
  const int species = static_cast<int>(options[1]);
  const auto seed = static_cast<std::uint32_t>(mix_bits(static_cast<std::uint64_t>(options[2])));
  SceneParts parts;
  std::vector<std::uint32_t> objects;
  for (int i = 0; i < species; ++i) {
    const TreeSpecies& kind = tree_species(i);
    objects.push_back(
        parts.add(kind.name, grow_tree(parts, kind, seed + static_cast<std::uint32_t>(i))));
  }
  Layout layout(trees, seed);
  layout.plant(trees, species);
  add_ground(parts, layout, seed);
  add_water(parts);
  Random random(seed, 43);
  for (const Tree& tree : layout.trees()) {
    const glm::vec2 p = tree.position;
    const glm::dvec3 foot(p.x, layout.height(p.x, p.y), p.y);
    parts.put(objects[tree.species], foot, random.angle(), tree.scale);
  }
  scatter_undergrowth(parts, layout, static_cast<int>(options[3]), seed);
  parts.scene.lighting.ambient = {0.35f, 0.4f, 0.45f};
  parts.scene.lighting.lights = {sun_light({0.75f, 0.8f, 0.3f}, {1.9f, 1.75f, 1.45f})};
  parts.scene.environment = {{0.14f, 0.30f, 0.64f}, {0.62f, 0.74f, 0.86f}, {0.10f, 0.10f, 0.07f}};
  parts.scene.environment.fog_density = static_cast<float>(options[4]);
  parts.scene.home = home_on_loop({0, 0, 0}, kForestLoopRadius, 1.7, 0, 1.4);
  return std::move(parts.scene);
}

}  // namespace mirage::builtin
