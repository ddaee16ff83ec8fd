#include "server/scene/builtin/room_props.h"

#include <array>
#include <cmath>

namespace mirage::builtin {
namespace {

constexpr std::array<std::uint32_t, 8> kCovers = {0x8c2f2b, 0x2b4f7a, 0x3d6b45, 0xb98a3a,
                                                  0x5a3d6b, 0x2f2f33, 0xc7b79a, 0x1f6d73};

/// Adds an upright book with its spine to +z, from x on; returns its thickness.
float add_book(MeshBuilder& b, const RoomMaterials& m, Random& random, float x) {
  const float thick = random.range(0.028f, 0.05f);
  const float high = random.range(0.2f, 0.29f);
  const float deep = high * 0.7f;
  const glm::vec3 cover = rgb(kCovers[random.index(8)]);
  const float z0 = 0.1f - deep;
  b.use(m.matte).paint(cover);
  b.rounded_box({x, 0, z0}, {x + 0.004f, high, 0.1f}, 0.0015f);
  b.rounded_box({x + thick - 0.004f, 0, z0}, {x + thick, high, 0.1f}, 0.0015f);
  b.rounded_box({x, 0, 0.094f}, {x + thick, high, 0.102f}, 0.0035f);
  b.paint({0.72f, 0.67f, 0.55f});
  b.box({x + 0.004f, 0.004f, z0 + 0.004f}, {x + thick - 0.004f, high - 0.004f, 0.095f});
  b.paint({0.75f, 0.6f, 0.25f});
  b.box({x + 0.004f, high * 0.72f, 0.1f}, {x + thick - 0.004f, high * 0.8f, 0.1035f});
  return thick;
}

}  // namespace

Mesh make_book(const RoomMaterials& m, std::uint32_t seed) {
  MeshBuilder b;
  Random random(seed, 61);
  // The book lies flat: its spine's x axis points up.
  b.place(glm::rotate(glm::mat4(1), 1.5707963f, glm::vec3(0, 0, 1)));
  add_book(b, m, random, 0);
  for (Vertex& v : b.vertices()) v.position.x += 0.12f;
  return b.take();
}

Mesh make_book_row(const RoomMaterials& m, std::uint32_t seed) {
  MeshBuilder b;
  Random random(seed, 62);
  float x = -0.13f;
  for (int i = 0; i < 6; ++i) x += add_book(b, m, random, x) + 0.001f;
  return b.take();
}

Mesh make_mug(const RoomMaterials& m, glm::vec3 color) {
  MeshBuilder b;
  b.use(m.glossy).paint(color);
  const std::array<glm::vec2, 8> cup = {{{0, 0},
                                         {0.036f, 0},
                                         {0.041f, 0.006f},
                                         {0.042f, 0.095f},
                                         {0.04f, 0.098f},
                                         {0.038f, 0.095f},
                                         {0.037f, 0.082f},
                                         {0, 0.081f}}};
  b.lathe(cup, 32);
  std::array<glm::vec3, 9> loop;
  std::array<float, 9> radii;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const float a = -1.5f + 3.0f * static_cast<float>(i) / 8.0f;
    loop[i] = {0.037f + 0.03f * std::cos(a), 0.05f + 0.03f * std::sin(a), 0};
    radii[i] = i == 0 || i == 8 ? 0 : 0.006f;
  }
  b.tube(loop, radii, 10);
  b.paint({0.08f, 0.04f, 0.02f});
  b.cylinder({0, 0.08f, 0}, 0.0368f, 0.002f, 32);
  return b.take();
}

Mesh make_desk_lamp(const RoomMaterials& m) {
  MeshBuilder b;
  b.use(m.metal).paint({0.6f, 0.16f, 0.08f});
  b.cylinder({0, 0, 0}, 0.085f, 0.018f, 32);
  b.rod({0, 0.015f, 0}, {0, 0.27f, -0.1f}, 0.009f, 12);
  b.rod({0, 0.27f, -0.1f}, {0, 0.43f, 0.1f}, 0.009f, 12);
  b.sphere({0, 0.27f, -0.1f}, glm::vec3(0.016f), 8, 14);
  b.place(glm::rotate(glm::translate(glm::mat4(1), {0, 0.43f, 0.1f}), 0.5f, glm::vec3(1, 0, 0)));
  const std::array<glm::vec2, 5> shade = {
      {{0.085f, -0.09f}, {0.075f, -0.05f}, {0.04f, 0}, {0.02f, 0.025f}, {0, 0.03f}}};
  b.lathe(shade, 28);
  b.use(m.glow);
  const std::array<glm::vec2, 3> bulb = {{{0, -0.092f}, {0.084f, -0.088f}, {0, -0.08f}}};
  b.lathe(bulb, 28);
  return b.take();
}

Mesh make_pot_plant(const RoomMaterials& m, std::uint32_t seed) {
  MeshBuilder b;
  Random random(seed, 63);
  b.use(m.matte).paint({0.42f, 0.17f, 0.09f});
  const std::array<glm::vec2, 7> pot = {{{0, 0},
                                         {0.07f, 0},
                                         {0.095f, 0.13f},
                                         {0.105f, 0.13f},
                                         {0.105f, 0.16f},
                                         {0.09f, 0.16f},
                                         {0.088f, 0.14f}}};
  b.lathe(pot, 28);
  b.paint({0.05f, 0.035f, 0.025f});
  b.cylinder({0, 0.12f, 0}, 0.092f, 0.02f, 28);
  for (int i = 0; i < 34; ++i) {
    const float a = 2.39996f * static_cast<float>(i);
    const float rise = 1 - static_cast<float>(i) / 40.0f;
    const float length = random.range(0.24f, 0.36f);
    const glm::vec3 out(std::cos(a), 0, std::sin(a));
    b.paint(glm::vec3(0.05f, 0.19f, 0.045f) * random.range(0.6f, 1.3f));
    b.place(
        glm::mat4(glm::vec4(glm::cross(glm::vec3(0, 1, 0), out), 0),
                  glm::vec4(glm::normalize(glm::vec3(0, rise, 0) * 1.4f + out * 0.7f), 0),
                  glm::vec4(glm::cross(glm::cross(glm::vec3(0, 1, 0), out),
                                       glm::normalize(glm::vec3(0, rise, 0) * 1.4f + out * 0.7f)),
                            0),
                  glm::vec4(out * 0.03f + glm::vec3(0, 0.14f, 0), 1)));
    b.sphere({0, length * 0.5f, 0}, {0.032f, length * 0.5f, 0.006f}, 6, 6);
  }
  b.reset();
  b.shade([](glm::vec3 p, glm::vec3) {
    const float core = glm::length(glm::vec2(p.x, p.z));
    return p.y < 0.15f ? 1.0f
                       : 0.4f + 0.6f * glm::smoothstep(0.0f, 0.2f, core + 0.5f * (p.y - 0.2f));
  });
  return b.take();
}

Mesh make_ball(const RoomMaterials& m, glm::vec3 a, glm::vec3 c) {
  MeshBuilder b;
  b.use(m.glossy).sphere({0, 0.11f, 0}, glm::vec3(0.11f), 24, 36);
  for (Vertex& v : b.vertices()) {
    const bool stripe = static_cast<int>(v.uv0.x * 5.999f) % 2 == 0;
    v.color = glm::u16vec4(glm::u16vec3((stripe ? a : c) * 65535.0f), 65535);
  }
  return b.take();
}

Mesh make_carton(const RoomMaterials& m) {
  MeshBuilder b;
  b.use(m.matte).paint({0.42f, 0.28f, 0.15f});
  b.rounded_box({-0.16f, 0, -0.12f}, {0.16f, 0.22f, 0.12f}, 0.006f, 2);
  b.paint({0.6f, 0.5f, 0.33f});
  b.box({-0.161f, 0.2f, -0.025f}, {0.161f, 0.2215f, 0.025f});
  b.paint({0.8f, 0.8f, 0.78f});
  b.box({-0.06f, 0.08f, 0.115f}, {0.08f, 0.16f, 0.1212f});
  return b.take();
}

Mesh make_vase(const RoomMaterials& m, glm::vec3 color) {
  MeshBuilder b;
  b.use(m.glossy).paint(color);
  std::array<glm::vec2, 20> profile;
  for (std::size_t i = 1; i < 17; ++i) {
    const float t = static_cast<float>(i - 1) / 15.0f;
    profile[i] = {0.05f + 0.045f * std::sin(3.6f * t + 0.1f) + 0.02f * t * t, 0.3f * t};
  }
  profile[0] = {0, 0};
  profile[17] = {profile[16].x - 0.008f, 0.3f};
  profile[18] = {profile[15].x - 0.012f, 0.26f};
  profile[19] = {0, 0.25f};
  b.lathe(profile, 32);
  return b.take();
}

Mesh make_monitor(const RoomMaterials& m) {
  MeshBuilder b;
  b.use(m.matte).paint(glm::vec3(0.025f));
  b.rounded_box({-0.3f, 0.12f, -0.02f}, {0.3f, 0.48f, 0.02f}, 0.01f, 2);
  b.rounded_box({-0.12f, 0, -0.1f}, {0.12f, 0.014f, 0.08f}, 0.006f, 2);
  b.rod({0, 0.01f, -0.04f}, {0, 0.25f, -0.03f}, 0.018f, 12);
  b.use(m.screen);
  const float z = 0.0212f;
  b.face({-0.285f, 0.465f, z}, {-0.285f, 0.135f, z}, {0.285f, 0.135f, z}, {0.285f, 0.465f, z});
  // `face` runs u along its first edge, but the picture's top row belongs at the top.
  auto& v = b.vertices();
  const std::size_t n = v.size();
  const std::array<glm::vec2, 4> uv = {{{0, 0}, {0, 1}, {1, 1}, {1, 0}}};
  for (std::size_t i = 0; i < 4; ++i) v[n - 4 + i].uv0 = uv[i];
  return b.take();
}

Mesh make_keyboard(const RoomMaterials& m) {
  MeshBuilder b;
  b.use(m.matte).paint(glm::vec3(0.05f));
  b.rounded_box({-0.21f, 0, -0.065f}, {0.21f, 0.016f, 0.065f}, 0.006f, 2);
  b.paint(glm::vec3(0.55f));
  for (int row = 0; row < 5; ++row) {
    for (int k = 0; k < 15; ++k) {
      const float x = -0.2f + 0.0268f * static_cast<float>(k);
      const float z = -0.057f + 0.0232f * static_cast<float>(row);
      b.box({x, 0.012f, z}, {x + 0.022f, 0.022f, z + 0.019f});
    }
  }
  return b.take();
}

Mesh make_picture_frame(const RoomMaterials& m) {
  MeshBuilder b;
  b.use(m.wood).paint(glm::vec3(0.8f));
  b.rounded_box({-0.45f, 0, 0.004f}, {0.45f, 0.05f, 0.035f}, 0.008f, 2);
  b.rounded_box({-0.45f, 0.6f, 0.004f}, {0.45f, 0.65f, 0.035f}, 0.008f, 2);
  b.rounded_box({-0.45f, 0.04f, 0.004f}, {-0.4f, 0.61f, 0.035f}, 0.008f, 2);
  b.rounded_box({0.4f, 0.04f, 0.004f}, {0.45f, 0.61f, 0.035f}, 0.008f, 2);
  b.use(m.picture).paint(glm::vec3(1));
  b.box({-0.41f, 0.04f, 0.002f}, {0.41f, 0.61f, 0.018f});
  for (Vertex& v : b.vertices()) {
    if (v.normal.z > 0.99f)
      v.uv0 = {v.position.x / 0.84f + 0.5f, 1 - (v.position.y - 0.03f) / 0.6f};
  }
  return b.take();
}

Mesh make_bottle(const RoomMaterials& m, glm::vec3 color) {
  MeshBuilder b;
  b.use(m.glossy).paint(color);
  const std::array<glm::vec2, 11> glass = {{{0, 0},
                                            {0.034f, 0},
                                            {0.037f, 0.006f},
                                            {0.037f, 0.16f},
                                            {0.033f, 0.19f},
                                            {0.02f, 0.215f},
                                            {0.014f, 0.235f},
                                            {0.013f, 0.275f},
                                            {0.016f, 0.278f},
                                            {0.016f, 0.29f},
                                            {0, 0.29f}}};
  b.lathe(glass, 28);
  b.use(m.matte).paint({0.75f, 0.7f, 0.58f});
  const std::array<glm::vec2, 4> label = {
      {{0.0368f, 0.05f}, {0.0374f, 0.051f}, {0.0374f, 0.13f}, {0.0368f, 0.131f}}};
  b.lathe(label, 28);
  return b.take();
}

Mesh make_bowl(const RoomMaterials& m, std::uint32_t seed) {
  MeshBuilder b;
  Random random(seed, 64);
  b.use(m.glossy).paint({0.65f, 0.63f, 0.58f});
  const std::array<glm::vec2, 9> bowl = {{{0, 0},
                                          {0.05f, 0},
                                          {0.055f, 0.01f},
                                          {0.1f, 0.04f},
                                          {0.13f, 0.08f},
                                          {0.124f, 0.081f},
                                          {0.095f, 0.046f},
                                          {0.05f, 0.02f},
                                          {0, 0.016f}}};
  b.lathe(bowl, 36);
  for (int i = 0; i < 7; ++i) {
    const float a = 1.05f * static_cast<float>(i);
    const float r = i == 6 ? 0.0f : 0.066f;
    b.paint(i % 2 == 0 ? glm::vec3(0.55f, 0.05f, 0.03f) : glm::vec3(0.6f, 0.3f, 0.03f));
    b.sphere({r * std::cos(a), i == 6 ? 0.095f : 0.066f, r * std::sin(a)},
             glm::vec3(random.range(0.033f, 0.037f)), 8, 14);
  }
  return b.take();
}

Mesh make_globe(const RoomMaterials& m, std::uint32_t seed) {
  MeshBuilder b;
  b.use(m.glossy).paint({0.06f, 0.2f, 0.42f});
  b.sphere({0, 0.2f, 0}, glm::vec3(0.12f), 28, 48);
  for (Vertex& v : b.vertices()) {
    const float land = fractal_noise((v.position - glm::vec3(0, 0.2f, 0)) * 14.0f + 30.0f, seed);
    if (land > 0.54f) v.color = glm::u16vec4(glm::u16vec3(13000, 21000, 6000), 65535);
  }
  b.use(m.metal).paint({0.5f, 0.36f, 0.15f});
  b.cylinder({0, 0, 0}, 0.075f, 0.015f, 28);
  b.rod({0, 0.01f, 0}, {0, 0.08f, 0}, 0.012f, 12);
  return b.take();
}

}  // namespace mirage::builtin
