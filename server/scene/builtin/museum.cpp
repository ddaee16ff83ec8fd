// Heavy sculptures in a round hall, on rings about the circular walk.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "server/scene/builtin/museum_hall.h"
#include "server/scene/builtin/sculpture_cache.h"
#include "server/scene/builtin/tau.h"

namespace mirage::builtin {
namespace {

constexpr float kMuseumLoopRadius = 8;
constexpr float kApart = 2.8f;        // metres between neighbouring sculptures on a ring
constexpr float kBehind = 3.1f;       // metres from the last ring to the wall
constexpr float kNearestRing = 2.4f;  // metres from the walk
constexpr float kBetweenRings = 3.0f;
/// Range relative to the mean. The default then gives 300,000 to 1,000,000 triangles with some
/// margin: solids come out a few per cent off.
constexpr float kFewest = 0.5f, kMost = 1.5f;

struct Stand {
  float angle;   ///< along the walk, from its start
  float radius;  ///< from the hall's axis

  /// The walk starts at -x and goes towards -z.
  glm::vec2 position() const { return {-radius * std::cos(angle), -radius * std::sin(angle)}; }
};

void add_ring(std::vector<Stand>& spots, float radius, float turn) {
  const int count = static_cast<int>(kTau * radius / kApart);
  for (int i = 0; i < count; ++i) {
    spots.push_back({kTau * (static_cast<float>(i) + turn) / static_cast<float>(count), radius});
  }
}

/// The rings on both sides of the walk come first, each filled along it.
std::vector<Stand> spots_for(std::size_t objects) {
  std::vector<Stand> spots;
  for (int step = 0; spots.size() < objects; ++step) {
    const std::size_t first = spots.size();
    const float off = kNearestRing + kBetweenRings * static_cast<float>(step);
    const float turn = 0.5f * static_cast<float>(step % 2);
    add_ring(spots, kMuseumLoopRadius + off, 0.5f + turn);
    if (off + 1 < kMuseumLoopRadius) add_ring(spots, kMuseumLoopRadius - off, turn);
    std::sort(spots.begin() + static_cast<std::ptrdiff_t>(first), spots.end(),
              [](const Stand& a, const Stand& b) {
                return a.angle < b.angle || (a.angle == b.angle && a.radius < b.radius);
              });
  }
  spots.resize(objects);
  return spots;
}

std::vector<Sculpture> make_sculptures(std::size_t count, double mean_triangles, std::uint32_t seed,
                                       const LoadTools& tools) {
  std::vector<Sculpture> sculptures(count);
  StageProgress progress(tools.progress, "sculptures", count);
  tools.workers.each(count, [&](std::size_t i) {
    const auto number = static_cast<std::uint32_t>(i);
    Random random(seed, 2000 + number);
    const double triangles = mean_triangles * static_cast<double>(random.range(kFewest, kMost));
    sculptures[i] =
        find_or_make_sculpture(seed, number, static_cast<std::size_t>(triangles), tools.cache);
    progress.one_done();
  });
  return sculptures;
}

std::int32_t add_map(SceneParts& parts, Image image) {
  return image.rgba.empty() ? -1 : parts.add(std::move(image));
}

std::uint32_t add_sculpture(SceneParts& parts, Sculpture sculpture) {
  SculptureFinish& finish = sculpture.finish;
  Material m = painted_material(finish.roughness, finish.metallic);
  m.base_color_map.image = add_map(parts, std::move(finish.color));
  m.metal_rough_map.image = add_map(parts, std::move(finish.metal_rough));
  m.normal_map.image = add_map(parts, std::move(finish.normal));
  sculpture.mesh.primitives[0].material = parts.add(m);
  return parts.add(std::move(sculpture.name), std::move(sculpture.mesh));
}

void light_hall(Scene& scene, const Hall& hall) {
  scene.lighting.ambient = {0.36f, 0.36f, 0.38f};
  scene.lighting.lights = {sun_light({-0.35f, 0.8f, 0.45f}, {1.15f, 1.12f, 1.05f})};
  for (int i = 0; i < 4; ++i) {
    const float a = kTau * (static_cast<float>(i) + 0.5f) / 4;
    Light lamp;
    lamp.kind = LightKind::kPoint;
    lamp.color = glm::vec3(20, 16.5f, 12.5f);
    lamp.position = {hall.loop_radius * std::cos(a), 5.2, hall.loop_radius * std::sin(a)};
    scene.lighting.lights.push_back(lamp);
  }
  scene.environment = {glm::vec3(0.5f), glm::vec3(0.4f), glm::vec3(0.2f)};
}

}  // namespace

Scene build_museum(const OptionValues& options, const LoadTools& tools) {
  const auto objects = static_cast<std::size_t>(options[0]);
  const auto seed = static_cast<std::uint32_t>(mix_bits(static_cast<std::uint64_t>(options[1])));
  std::vector<Sculpture> sculptures = make_sculptures(objects, options[2], seed, tools);
  const std::vector<Stand> spots = spots_for(objects);
  Hall hall;
  hall.loop_radius = kMuseumLoopRadius;
  hall.radius = kMuseumLoopRadius + kNearestRing + kBehind;
  SceneParts parts;
  const Plinths plinths(parts, seed);
  Random random(seed, 122);
  for (std::size_t i = 0; i < objects; ++i) {
    const glm::vec2 p = spots[i].position();
    const Plinth& plinth = plinths.under(sculptures[i].height, random.chance(0.4f));
    // The face of a sculpture, +x, is turned to the walk.
    const bool inside = spots[i].radius < kMuseumLoopRadius;
    const float yaw = -spots[i].angle + (inside ? 0.5f * kTau : 0.0f);
    parts.put(plinth.object, {p.x, 0, p.y}, -spots[i].angle);
    parts.put(add_sculpture(parts, std::move(sculptures[i])), {p.x, plinth.height, p.y},
              yaw + random.range(-0.35f, 0.35f));
    hall.shadows.emplace_back(p.x, p.y, kPlinthRadius - 0.2f);
    hall.radius = std::max(hall.radius, spots[i].radius + kBehind);
  }
  add_hall(parts, hall, seed);
  light_hall(parts.scene, hall);
  parts.scene.home = home_on_loop({0, 0, 0}, kMuseumLoopRadius, 1.65, 0, 1.2);
  return std::move(parts.scene);
}

}  // namespace mirage::builtin
