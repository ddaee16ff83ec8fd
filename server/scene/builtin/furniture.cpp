#include <array>

#include "server/scene/builtin/room_props.h"
#include "server/scene/builtin/texture_paint.h"

namespace mirage::builtin {
namespace {

constexpr float kShelfPitch = 0.38f;

void darken_below(MeshBuilder& builder, float height) {
  builder.shade([&](glm::vec3 p, glm::vec3 n) {
    return (0.6f + 0.4f * glm::smoothstep(0.0f, height, p.y)) * (n.y < -0.7f ? 0.55f : 1.0f);
  });
}

}  // namespace

RoomMaterials add_room_materials(SceneParts& parts, std::uint32_t seed) {
  RoomMaterials m;
  m.matte = parts.add(painted_material(0.85f));
  m.glossy = parts.add(painted_material(0.25f));
  m.metal = parts.add(painted_material(0.4f, 0.6f));
  m.wood = parts.add(textured_material(parts.add(paint_planks(seed + 1, 3)), 0.55f));
  Material screen = glowing_material(glm::vec3(0.9f));
  screen.emissive_map.image = parts.add(paint_screen(seed));
  m.screen = parts.add(screen);
  m.picture = parts.add(textured_material(parts.add(paint_picture(seed)), 0.7f));
  m.glow = parts.add(glowing_material({1.0f, 0.86f, 0.6f}));
  return m;
}

float shelf_board_height(int board) { return 0.1f + kShelfPitch * static_cast<float>(board); }

Mesh make_desk(const RoomMaterials& m) {
  MeshBuilder b;
  b.use(m.wood).paint(glm::vec3(1));
  b.rounded_box({-0.75f, kDeskHeight - 0.035f, -0.38f}, {0.75f, kDeskHeight, 0.38f}, 0.012f, 2);
  b.rounded_box({0.28f, 0.12f, -0.34f}, {0.7f, kDeskHeight - 0.035f, 0.34f}, 0.01f, 2);
  for (int i = 0; i < 3; ++i) {
    const float y = 0.14f + 0.19f * static_cast<float>(i);
    b.rounded_box({0.3f, y, 0.33f}, {0.68f, y + 0.175f, 0.355f}, 0.008f);
    b.use(m.metal).paint(glm::vec3(0.7f));
    b.rod({0.42f, y + 0.09f, 0.37f}, {0.56f, y + 0.09f, 0.37f}, 0.008f, 10);
    b.use(m.wood).paint(glm::vec3(1));
  }
  b.use(m.metal).paint(glm::vec3(0.25f));
  for (const float x : {-0.68f, 0.66f}) {
    for (const float z : {-0.3f, 0.3f}) {
      b.rod({x, 0, z}, {x, x < 0 ? kDeskHeight - 0.035f : 0.13f, z}, 0.025f, 12);
    }
  }
  b.rod({-0.68f, 0.12f, -0.3f}, {-0.68f, 0.12f, 0.3f}, 0.018f, 10);
  darken_below(b, 0.7f);
  return b.take();
}

Mesh make_chair(const RoomMaterials& m, glm::vec3 color) {
  MeshBuilder b;
  b.use(m.matte).paint(color);
  b.rounded_box({-0.24f, 0.43f, -0.23f}, {0.24f, 0.51f, 0.25f}, 0.035f, 3);
  b.rounded_box({-0.23f, 0.6f, -0.27f}, {0.23f, 1.0f, -0.21f}, 0.028f, 3);
  b.use(m.metal).paint(glm::vec3(0.3f));
  b.rod({0, 0.08f, 0}, {0, 0.44f, 0}, 0.028f, 14);
  b.rod({0, 0.46f, -0.22f}, {0, 0.75f, -0.28f}, 0.02f, 10);
  for (int i = 0; i < 5; ++i) {
    const float a = 1.256637f * static_cast<float>(i);
    const glm::vec3 foot(0.29f * std::cos(a), 0.06f, 0.29f * std::sin(a));
    b.rod({0, 0.1f, 0}, foot, 0.018f, 10);
    b.sphere(foot - glm::vec3(0, 0.028f, 0), glm::vec3(0.03f), 6, 10);
  }
  darken_below(b, 0.55f);
  return b.take();
}

Mesh make_shelf(const RoomMaterials& m) {
  MeshBuilder b;
  b.use(m.wood).paint(glm::vec3(0.95f));
  const float top = shelf_board_height(kShelfBoards) + 0.02f;
  for (const float x : {-0.6f, 0.57f}) {
    b.rounded_box({x, 0, -0.17f}, {x + 0.03f, top, 0.17f}, 0.006f);
  }
  for (int i = 0; i <= kShelfBoards; ++i) {
    const float y = shelf_board_height(i);
    b.rounded_box({-0.575f, y - 0.025f, -0.165f}, {0.575f, y, 0.165f}, 0.006f);
  }
  b.paint(glm::vec3(0.6f));
  b.box({-0.58f, 0.07f, -0.168f}, {0.58f, top - 0.02f, -0.158f});
  // The depth of each compartment is dark.
  b.shade([](glm::vec3 p, glm::vec3 n) {
    const float inner = std::abs(n.x) < 0.9f || std::abs(p.x) < 0.58f ? 1.0f : 0.0f;
    return 1 - inner * 0.5f * glm::smoothstep(0.16f, -0.16f, p.z);
  });
  return b.take();
}

Mesh make_sofa(const RoomMaterials& m) {
  MeshBuilder b;
  b.use(m.matte).paint({0.10f, 0.19f, 0.22f});
  b.rounded_box({-0.95f, 0.12f, -0.4f}, {0.95f, 0.34f, 0.4f}, 0.05f, 3);
  b.rounded_box({-0.95f, 0.3f, -0.42f}, {0.95f, 0.84f, -0.2f}, 0.09f, 4);
  for (const float x : {-1.0f, 0.82f}) {
    b.rounded_box({x, 0.12f, -0.42f}, {x + 0.18f, 0.6f, 0.42f}, 0.07f, 4);
  }
  b.paint({0.14f, 0.25f, 0.28f});
  for (const float x : {-0.8f, 0.01f}) {
    b.rounded_box({x, 0.33f, -0.22f}, {x + 0.79f, 0.48f, 0.4f}, 0.06f, 4);
  }
  b.paint({0.62f, 0.33f, 0.08f});
  b.rounded_box({-0.75f, 0.48f, -0.2f}, {-0.35f, 0.84f, -0.07f}, 0.06f, 4);
  b.use(m.wood).paint(glm::vec3(0.6f));
  for (const float x : {-0.85f, 0.85f}) {
    for (const float z : {-0.32f, 0.32f}) b.cylinder({x, 0, z}, 0.03f, 0.13f, 12);
  }
  darken_below(b, 0.5f);
  return b.take();
}

Mesh make_floor_lamp(const RoomMaterials& m) {
  MeshBuilder b;
  b.use(m.metal).paint(glm::vec3(0.35f));
  const std::array<glm::vec2, 6> base = {
      {{0, 0}, {0.15f, 0}, {0.15f, 0.02f}, {0.04f, 0.04f}, {0.014f, 0.06f}, {0.014f, 1.5f}}};
  b.lathe(base, 28);
  b.use(m.glow);
  const std::array<glm::vec2, 4> shade = {{{0, 1.38f}, {0.21f, 1.35f}, {0.14f, 1.7f}, {0, 1.7f}}};
  b.lathe(shade, 36);
  return b.take();
}

Mesh make_pendant(const RoomMaterials& m) {
  MeshBuilder b;
  b.use(m.metal).paint({0.2f, 0.19f, 0.17f});
  const std::array<glm::vec2, 7> shade = {{{0.22f, -0.62f},
                                           {0.21f, -0.56f},
                                           {0.15f, -0.46f},
                                           {0.06f, -0.4f},
                                           {0.01f, -0.38f},
                                           {0.008f, -0.02f},
                                           {0, -0.001f}}};
  b.lathe(shade, 32);
  b.use(m.glow);
  const std::array<glm::vec2, 4> bulb = {
      {{0, -0.64f}, {0.17f, -0.625f}, {0.218f, -0.618f}, {0, -0.6f}}};
  b.lathe(bulb, 32);
  return b.take();
}

}  // namespace mirage::builtin
