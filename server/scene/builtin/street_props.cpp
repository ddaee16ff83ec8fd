#include <array>
#include <cmath>

#include "server/scene/builtin/buildings.h"
#include "server/scene/builtin/tree_builder.h"

namespace mirage::builtin {

Mesh make_street_lamp(const CityMaterials& m) {
  MeshBuilder b;
  b.use(m.metal).paint(glm::vec3(0.12f));
  const std::array<glm::vec2, 7> post = {
      {{0, 0}, {0.14f, 0}, {0.13f, 0.5f}, {0.08f, 0.6f}, {0.06f, 3}, {0.05f, 5.2f}, {0, 5.22f}}};
  b.lathe(post, 16);
  const std::array<glm::vec3, 4> arm = {
      glm::vec3(0, 5.1f, 0), {0, 5.5f, 0.25f}, {0, 5.6f, 0.7f}, {0, 5.58f, 1.2f}};
  const std::array<float, 4> radii = {0.04f, 0.04f, 0.035f, 0};
  b.tube(arm, radii, 10);
  b.rounded_box({-0.14f, 5.5f, 0.9f}, {0.14f, 5.62f, 1.6f}, 0.05f, 3);
  b.paint({0.8f, 0.78f, 0.7f});
  b.box({-0.1f, 5.485f, 0.95f}, {0.1f, 5.51f, 1.55f});
  return b.take();
}

Mesh make_street_tree(const CityMaterials& m, std::uint32_t seed) {
  MeshBuilder b;
  Random random(seed, 72);
  b.use(m.matte).paint({0.11f, 0.085f, 0.06f});
  const std::array<glm::vec3, 4> trunk = {
      glm::vec3(0, -0.1f, 0), {0.03f, 1.2f, 0}, {-0.02f, 2.6f, 0.03f}, {0, 5.2f, 0}};
  const std::array<float, 4> radii = {0.19f, 0.14f, 0.11f, 0};
  b.tube(trunk, radii, 12);
  for (int i = 0; i < 8; ++i) {
    const float a = 2.39996f * static_cast<float>(i);
    const glm::vec3 out(std::cos(a), 0, std::sin(a));
    const float y = 2.2f + 0.25f * static_cast<float>(i);
    const std::array<glm::vec3, 3> path = {glm::vec3(0, y, 0),
                                           out * 0.7f + glm::vec3(0, y + 0.7f, 0),
                                           out * 1.3f + glm::vec3(0, y + 1.1f, 0)};
    const std::array<float, 3> thin = {0.06f, 0.035f, 0};
    b.tube(path, thin, 6);
  }
  b.use(m.leaves);
  const glm::vec3 center(0, 4.1f, 0);
  const glm::vec3 radius(1.9f, 1.95f, 1.9f);
  for (int i = 0; i < 1100; ++i) {
    const glm::vec3 out = random.direction();
    const float lump = 0.78f + 0.44f * value_noise(out * 2.2f + 9.0f, seed);
    const float depth = 1 - 0.5f * random.unit() * random.unit();
    const glm::vec3 p = center + out * radius * (lump * depth);
    const float low = 0.5f + 0.5f * glm::smoothstep(2.2f, 5.2f, p.y);
    b.paint(glm::vec3(random.range(0.85f, 1.05f), 1, 0.9f) *
            (low * (0.35f + 0.65f * glm::smoothstep(0.5f, 1.0f, depth))));
    const glm::vec3 facing = glm::normalize(out + random.direction());
    add_leaf_card(b, p, facing, out + glm::vec3(0, 0.3f, 0), random.range(0.45f, 0.65f),
                  random.angle());
  }
  return b.take();
}

Mesh make_car(const CityMaterials& m, glm::vec3 color, bool van) {
  MeshBuilder b;
  const float roof = van ? 2.0f : 1.42f;
  b.use(m.paint).paint(color);
  b.rounded_box({-0.88f, 0.28f, -2.15f}, {0.88f, 0.86f, 2.15f}, 0.2f, 4);
  // The cabin leans in towards the roof.
  const std::uint32_t first = b.vertex_count();
  const float back = van ? -2.05f : -1.55f;
  b.rounded_box({-0.84f, 0.7f, back}, {0.84f, roof, van ? 1.5f : 0.95f}, 0.22f, 4);
  b.use(m.glass).paint({0.05f, 0.075f, 0.095f});
  b.rounded_box({-0.855f, 0.9f, back + 0.2f}, {0.855f, roof - 0.14f, van ? 1.35f : 0.8f}, 0.14f, 3);
  b.rounded_box({-0.7f, 0.88f, van ? 1.2f : -1.6f}, {0.7f, roof - 0.14f, van ? 1.53f : 1.0f}, 0.1f,
                3);
  auto& v = b.vertices();
  for (std::size_t i = first; i < v.size(); ++i) {
    const float t = glm::clamp((v[i].position.y - 0.8f) / 0.7f, 0.0f, 1.0f);
    v[i].position.x *= 1 - 0.14f * t;
    v[i].position.z *= van ? 1.0f : 1 - 0.24f * t;
  }
  for (const float x : {-0.86f, 0.66f}) {
    for (const float z : {-1.35f, 1.35f}) {
      b.place(glm::rotate(glm::translate(glm::mat4(1), {x, 0.32f, z}), -1.5707963f,
                          glm::vec3(0, 0, 1)));
      b.use(m.matte).paint(glm::vec3(0.018f));
      b.cylinder({0, 0, 0}, 0.32f, 0.2f, 24);
      b.use(m.metal).paint(glm::vec3(0.5f));
      b.cylinder({0, -0.01f, 0}, 0.18f, 0.22f, 16);
    }
  }
  b.reset();
  for (const float x : {-0.72f, 0.42f}) {
    b.use(m.glass).paint({0.85f, 0.83f, 0.75f});
    b.rounded_box({x, 0.58f, 2.06f}, {x + 0.3f, 0.72f, 2.17f}, 0.04f, 2);
    b.paint({0.5f, 0.02f, 0.015f});
    b.rounded_box({x, 0.6f, -2.17f}, {x + 0.3f, 0.74f, -2.06f}, 0.04f, 2);
  }
  b.shade([](glm::vec3 p, glm::vec3 n) {
    return (0.5f + 0.5f * glm::smoothstep(0.15f, 0.7f, p.y)) * (n.y < -0.5f ? 0.4f : 1.0f);
  });
  return b.take();
}

Mesh make_bench(const CityMaterials& m) {
  MeshBuilder b;
  b.use(m.matte).paint({0.28f, 0.16f, 0.08f});
  for (int i = 0; i < 4; ++i) {
    const float z = -0.2f + 0.11f * static_cast<float>(i);
    b.rounded_box({-0.85f, 0.43f, z}, {0.85f, 0.47f, z + 0.09f}, 0.012f);
  }
  for (int i = 0; i < 3; ++i) {
    const float y = 0.56f + 0.12f * static_cast<float>(i);
    b.rounded_box({-0.85f, y, -0.27f}, {0.85f, y + 0.09f, -0.235f}, 0.012f);
  }
  b.use(m.metal).paint(glm::vec3(0.1f));
  for (const float x : {-0.65f, 0.65f}) {
    b.rod({x, 0, 0.18f}, {x, 0.44f, 0.18f}, 0.025f, 10);
    b.rod({x, 0, -0.2f}, {x, 0.9f, -0.285f}, 0.025f, 10);
    b.rod({x, 0.42f, -0.22f}, {x, 0.42f, 0.2f}, 0.02f, 10);
  }
  return b.take();
}

Mesh make_bin(const CityMaterials& m) {
  MeshBuilder b;
  b.use(m.metal).paint({0.06f, 0.13f, 0.08f});
  const std::array<glm::vec2, 8> can = {{{0, 0},
                                         {0.22f, 0},
                                         {0.25f, 0.75f},
                                         {0.28f, 0.78f},
                                         {0.28f, 0.82f},
                                         {0.2f, 0.92f},
                                         {0.08f, 0.97f},
                                         {0, 0.98f}}};
  b.lathe(can, 28);
  return b.take();
}

}  // namespace mirage::builtin
