#include "server/scene/builtin/plants.h"

#include <array>
#include <cmath>

#include "server/scene/builtin/texture_paint.h"
#include "server/scene/builtin/tree_builder.h"

namespace mirage::builtin {

PlantMaterials add_plant_materials(SceneParts& parts, std::uint32_t seed) {
  PlantMaterials m;
  LeafStyle grass{.count = 26,
                  .length = 0.95f,
                  .width = 0.032f,
                  .dark = {0.05f, 0.12f, 0.015f},
                  .light = {0.2f, 0.33f, 0.07f}};
  Material blades = card_material(parts.add(paint_grass(seed, grass)));
  // Grass is built from pairs of cards, one a side, so that both sides keep their upward normal.
  blades.double_sided = false;
  m.grass = parts.add(blades);
  const LeafStyle leaf{.count = 16,
                       .length = 0.28f,
                       .width = 0.6f,
                       .dark = {0.03f, 0.085f, 0.02f},
                       .light = {0.12f, 0.23f, 0.05f}};
  m.leaves = parts.add(card_material(parts.add(paint_leaf_cluster(seed + 1, leaf))));
  const LeafStyle frond{.count = 50,
                        .length = 0.42f,
                        .width = 0.16f,
                        .dark = {0.035f, 0.12f, 0.02f},
                        .light = {0.14f, 0.30f, 0.06f}};
  m.fern = parts.add(card_material(parts.add(paint_needle_frond(seed + 2, frond))));
  m.painted = parts.add(painted_material(0.8f));
  m.stone = parts.add(textured_material(parts.add(paint_mottle(seed + 3, 0.7f, 8)), 0.95f));
  return m;
}

Mesh grow_grass(const PlantMaterials& materials, std::uint32_t seed, float radius_m, int cards) {
  MeshBuilder builder;
  Random random(seed, 31);
  builder.use(materials.grass);
  for (int i = 0; i < cards; ++i) {
    const float r = radius_m * std::sqrt(random.unit());
    const float a = random.angle();
    const glm::vec3 foot(r * std::cos(a), -0.03f, r * std::sin(a));
    const float yaw = random.angle();
    const float height = random.range(0.28f, 0.5f) * (1.15f - 0.6f * r / radius_m);
    const float half = 0.5f * random.range(0.3f, 0.45f);
    const glm::vec3 side = glm::vec3(std::cos(yaw), 0, std::sin(yaw)) * half;
    const glm::vec3 lean = glm::vec3(-side.z, 0, side.x) * random.range(-0.6f, 0.6f);
    const float tone = random.range(0.7f, 1.0f);
    const glm::vec3 hue(random.range(0.8f, 1.0f), 1.0f, 0.8f);
    for (int face = 0; face < 2; ++face) {
      const glm::vec3 s = face == 0 ? side : -side;
      const float u0 = face == 0 ? 0.0f : 1.0f;
      const glm::vec3 top = foot + glm::vec3(0, height, 0) + lean;
      const glm::vec3 n = glm::normalize(glm::vec3(0, 1, 0) + foot * 0.5f);
      builder.paint(hue * (0.42f * tone));  // dark between the stems
      const std::uint32_t k = builder.vertex(foot - s, n, {u0, 1});
      builder.vertex(foot + s, n, {1 - u0, 1});
      builder.paint(hue * tone);
      builder.vertex(top + s, n, {1 - u0, 0});
      builder.vertex(top - s, n, {u0, 0});
      builder.quad(k, k + 1, k + 2, k + 3);
    }
  }
  return builder.take();
}

Mesh grow_fern(const PlantMaterials& materials, std::uint32_t seed) {
  MeshBuilder builder;
  Random random(seed, 32);
  builder.use(materials.fern);
  const int fronds = 26;
  for (int i = 0; i < fronds; ++i) {
    const float a = 2.39996f * static_cast<float>(i) + random.range(-0.2f, 0.2f);
    const float steep = random.range(0.5f, 1.25f);
    const float length = random.range(0.6f, 0.95f);
    const glm::vec3 out(std::cos(a), 0, std::sin(a));
    const glm::vec3 across = glm::vec3(-out.z, 0, out.x) * (0.16f * length / 0.8f);
    const float tone = random.range(0.75f, 1.0f);
    const std::uint32_t first = builder.vertex_count();
    const int steps = 6;
    for (int k = 0; k <= steps; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(steps);
      const float angle = steep - 1.5f * t;
      const glm::vec3 p = out * (length * t * std::cos(0.5f * (steep + angle))) +
                          glm::vec3(0, length * t * std::sin(0.5f * (steep + angle)) + 0.02f, 0);
      const glm::vec3 n = glm::normalize(glm::vec3(0, 1, 0) + out * (0.6f * t));
      builder.paint(glm::vec3(0.95f, 1, 0.9f) * (tone * (0.35f + 0.65f * t)));
      builder.vertex(p - across, n, {0, 1 - t});
      builder.vertex(p + across, n, {1, 1 - t});
    }
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(steps); ++k) {
      const std::uint32_t q = first + 2 * k;
      builder.quad(q, q + 1, q + 3, q + 2);
    }
  }
  return builder.take();
}

Mesh grow_bush(const PlantMaterials& materials, std::uint32_t seed, int cards) {
  MeshBuilder builder;
  Random random(seed, 33);
  builder.use(materials.painted).paint({0.06f, 0.045f, 0.03f});
  for (int i = 0; i < 7; ++i) {
    const float a = 0.9f * static_cast<float>(i);
    const glm::vec3 end(0.45f * std::cos(a), random.range(0.5f, 0.9f), 0.45f * std::sin(a));
    const std::array<glm::vec3, 3> path = {glm::vec3(0, -0.05f, 0), end * 0.55f, end};
    const std::array<float, 3> radii = {0.025f, 0.016f, 0};
    builder.tube(path, radii, 5);
  }
  builder.use(materials.leaves);
  const glm::vec3 center(0, 0.6f, 0);
  const glm::vec3 radii(0.75f, 0.6f, 0.75f);
  for (int i = 0; i < cards; ++i) {
    const glm::vec3 out = random.direction();
    const float lump = 0.8f + 0.4f * value_noise(out * 2.0f + 9.0f, seed);
    const float depth = 1 - 0.5f * random.unit() * random.unit();
    glm::vec3 p = center + out * radii * (lump * depth);
    p.y = glm::max(p.y, 0.08f);
    const float low = 0.45f + 0.55f * glm::smoothstep(0.0f, 1.1f, p.y);
    builder.paint(glm::vec3(random.range(0.85f, 1.05f), 1, 0.9f) *
                  (low * glm::smoothstep(0.2f, 1.0f, depth)));
    const glm::vec3 facing = glm::normalize(out + random.direction());
    const float side = random.range(0.26f, 0.4f);
    add_leaf_card(builder, p, facing, out + glm::vec3(0, 0.4f, 0), side, random.angle());
  }
  return builder.take();
}

Mesh grow_flower(const PlantMaterials& materials, std::uint32_t seed, glm::vec3 petal) {
  MeshBuilder builder;
  Random random(seed, 34);
  builder.use(materials.painted);
  for (int i = 0; i < 5; ++i) {
    const float a = 2.39996f * static_cast<float>(i);
    const float r = 0.05f + 0.03f * static_cast<float>(i);
    const glm::vec3 foot(r * std::cos(a), -0.03f, r * std::sin(a));
    const glm::vec3 head = foot * 1.5f + glm::vec3(0, random.range(0.22f, 0.42f), 0);
    builder.paint({0.07f, 0.2f, 0.03f});
    const std::array<glm::vec3, 3> path = {foot, glm::mix(foot, head, 0.5f) * 0.96f, head};
    const std::array<float, 3> radii = {0.007f, 0.006f, 0.004f};
    builder.tube(path, radii, 4);
    builder.paint(petal * random.range(0.8f, 1.0f));
    for (int k = 0; k < 7; ++k) {
      const float b = 0.897598f * static_cast<float>(k);
      const glm::vec3 out(std::cos(b), 0.35f, std::sin(b));
      builder.sphere(head + out * 0.032f, {0.022f, 0.009f, 0.022f}, 3, 6);
    }
    builder.paint({0.75f, 0.5f, 0.05f});
    builder.sphere(head + glm::vec3(0, 0.012f, 0), {0.018f, 0.012f, 0.018f}, 4, 8);
  }
  return builder.take();
}

Mesh grow_mushroom(const PlantMaterials& materials, std::uint32_t seed) {
  MeshBuilder builder;
  Random random(seed, 35);
  builder.use(materials.painted);
  for (int i = 0; i < 4; ++i) {
    const float a = 1.7f * static_cast<float>(i) + random.unit();
    const float size = random.range(0.6f, 1.2f) * (i == 0 ? 1.3f : 0.8f);
    const float r = i == 0 ? 0.0f : 0.13f;
    builder.place(glm::scale(
        glm::translate(glm::mat4(1), glm::vec3(r * std::cos(a), -0.02f, r * std::sin(a))),
        glm::vec3(size)));
    builder.paint({0.72f, 0.66f, 0.55f});
    const std::array<glm::vec2, 5> stem = {
        {{0, 0}, {0.03f, 0}, {0.022f, 0.05f}, {0.02f, 0.12f}, {0, 0.13f}}};
    builder.lathe(stem, 12);
    builder.paint({0.55f, 0.08f, 0.03f});
    const std::array<glm::vec2, 7> cap = {{{0, 0.105f},
                                           {0.06f, 0.1f},
                                           {0.085f, 0.105f},
                                           {0.08f, 0.13f},
                                           {0.06f, 0.155f},
                                           {0.03f, 0.17f},
                                           {0, 0.175f}}};
    builder.lathe(cap, 16);
  }
  builder.reset();
  builder.shade([](glm::vec3 p, glm::vec3 n) {
    return (0.5f + 0.5f * glm::smoothstep(0.0f, 0.1f, p.y)) * (n.y < -0.5f ? 0.5f : 1.0f);
  });
  return builder.take();
}

Mesh grow_rock(const PlantMaterials& materials, std::uint32_t seed, int rings) {
  MeshBuilder builder;
  Random random(seed, 36);
  const glm::vec3 stretch{random.range(0.4f, 0.6f), random.range(0.28f, 0.4f),
                          random.range(0.4f, 0.55f)};
  const auto surface = [&](glm::vec3 d) {
    // Flattened facets read as broken stone; noise alone reads as a potato.
    float reach = 0.75f + 0.5f * fractal_noise(d * 1.6f + 30.0f, seed);
    Random planes(seed, 37);
    for (int i = 0; i < 9; ++i) {
      const float along = glm::dot(d, planes.direction());
      const float cut = planes.range(0.62f, 0.85f);
      if (along > 1e-3f) reach = glm::min(reach, cut / along);
    }
    return d * reach * stretch + glm::vec3(0, 0.16f, 0);
  };
  builder.use(materials.stone).paint({0.36f, 0.345f, 0.32f});
  builder.sphere(glm::vec3(0), glm::vec3(1), rings, rings * 3 / 2);
  for (Vertex& v : builder.vertices()) {
    const glm::vec3 d = v.position;
    const glm::vec3 side = glm::normalize(
        glm::cross(std::abs(d.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0), d));
    const glm::vec3 other = glm::cross(d, side);
    const float step = 0.04f;
    const glm::vec3 du =
        surface(glm::normalize(d + side * step)) - surface(glm::normalize(d - side * step));
    const glm::vec3 dv =
        surface(glm::normalize(d + other * step)) - surface(glm::normalize(d - other * step));
    v.normal = glm::normalize(glm::cross(du, dv));
    v.position = surface(d);
    v.uv0 = {d.x + 0.5f * d.y, d.z + 0.5f * d.y};
  }
  builder.shade([](glm::vec3 p, glm::vec3 n) {
    return (0.45f + 0.55f * glm::smoothstep(0.0f, 0.25f, p.y)) * (0.75f + 0.25f * n.y);
  });
  return builder.take();
}

}  // namespace mirage::builtin
