#include "server/scene/builtin/buildings.h"

#include <array>

#include "server/scene/builtin/texture_paint.h"

namespace mirage::builtin {
namespace {

struct Style {
  const char* name;
  int floors;
  float floor_m;
  float half;          ///< half side of the footprint
  std::uint32_t wall;  ///< sRGB
  std::uint32_t trim;
  int windows;     ///< per floor and side
  float window_w;  ///< share of its bay
  float window_h;  ///< share of the floor
  bool sills;
  bool pitched;  ///< hipped roof; else parapet
  int set_back;  ///< floors above this one are set back; 0: none
};

constexpr std::array<Style, kBuildingKinds> kStyles = {{
    {"brick house", 5, 3.2f, 7.8f, 0x9a4f3a, 0xd8cdb8, 6, 0.5f, 0.6f, true, false, 0},
    {"plaster house", 4, 3.3f, 7.6f, 0xd9c08a, 0xf0ead8, 6, 0.45f, 0.62f, true, true, 0},
    {"office slab", 9, 3.4f, 7.6f, 0x9aa0a4, 0x5a6065, 8, 0.88f, 0.62f, false, false, 0},
    {"glass tower", 15, 3.5f, 7.2f, 0x4a5560, 0x303840, 10, 0.94f, 0.9f, false, false, 0},
    {"stone tower", 12, 3.4f, 7.8f, 0xb9ac94, 0x8f836c, 7, 0.5f, 0.64f, true, false, 8},
    {"red house", 4, 3.1f, 7.2f, 0xb86a4e, 0xe8dcc8, 5, 0.5f, 0.6f, true, true, 0},
    {"white block", 7, 3.1f, 7.8f, 0xdedbd2, 0x8c8f92, 6, 0.66f, 0.58f, true, false, 5},
    {"green house", 3, 3.4f, 7.4f, 0x8ea587, 0xefe8d8, 5, 0.48f, 0.6f, true, true, 0},
    {"brown office", 8, 3.6f, 7.8f, 0x7a5b45, 0x3c3430, 9, 0.72f, 0.7f, false, false, 0},
}};

void add_side(MeshBuilder& b, const CityMaterials& m, const Style& s, float half, int floor0,
              int floors, Random& random) {
  const float bay = 2 * half / static_cast<float>(s.windows);
  for (int f = floor0; f < floors; ++f) {
    const bool shop = f == 0;
    const float y = s.floor_m * static_cast<float>(f);
    const float high = s.floor_m * (shop ? 0.74f : s.window_h);
    const float low = y + (shop ? 0.25f : 0.55f * (s.floor_m - high));
    for (int i = 0; i < s.windows; ++i) {
      const float w = 0.5f * bay * (shop ? 0.82f : s.window_w);
      const float x = -half + bay * (static_cast<float>(i) + 0.5f);
      const float z = half + 0.03f;
      // Rooms behind the panes differ; higher panes mirror more sky.
      const float sky = random.range(0.05f, 0.2f) + 0.012f * static_cast<float>(f);
      const bool curtain = !shop && random.chance(0.2f);
      b.use(m.glass).paint(curtain ? glm::vec3(0.45f, 0.42f, 0.36f)
                                   : glm::vec3(0.55f, 0.8f, 1.0f) * sky);
      b.face({x - w, low, z}, {x + w, low, z}, {x + w, low + high, z}, {x - w, low + high, z});
      if (!s.sills && !shop) continue;
      b.use(m.matte).paint(rgb(s.trim));
      b.box({x - w - 0.08f, low - 0.12f, half - 0.02f}, {x + w + 0.08f, low, half + 0.16f});
      b.box({x - w - 0.06f, low + high, half - 0.02f},
            {x + w + 0.06f, low + high + 0.12f, half + 0.1f});
    }
  }
}

void add_block(MeshBuilder& b, const CityMaterials& m, const Style& s, float half, int floor0,
               int floors, Random& random) {
  const float low = s.floor_m * static_cast<float>(floor0);
  const float top = s.floor_m * static_cast<float>(floors);
  for (int side = 0; side < 4; ++side) {
    b.place(glm::rotate(glm::mat4(1), 1.5707963f * static_cast<float>(side), glm::vec3(0, 1, 0)));
    b.use(m.wall).paint(rgb(s.wall));
    b.grid_face({-half, low, half}, {half, low, half}, {-half, top, half}, 4, 8,
                {half * 0.5f, (top - low) * 0.25f});
    add_side(b, m, s, half, floor0, floors, random);
    b.use(m.matte).paint(rgb(s.trim));
    b.box({-half - 0.12f, low + (floor0 == 0 ? s.floor_m - 0.2f : 0.0f), half - 0.05f},
          {half + 0.12f, low + (floor0 == 0 ? s.floor_m + 0.05f : 0.2f), half + 0.2f});
    b.box({-half - 0.2f, top - 0.25f, half - 0.3f}, {half + 0.2f, top + 0.5f, half + 0.2f});
  }
  b.reset();
  b.use(m.wall).paint(glm::vec3(0.2f));
  b.face({-half, top, half}, {half, top, half}, {half, top, -half}, {-half, top, -half});
}

void add_roof(MeshBuilder& b, const CityMaterials& m, const Style& s, float half, float top,
              Random& random) {
  if (s.pitched) {
    b.use(m.wall).paint(rgb(0x7a3b2c));
    const float out = half + 0.5f;
    const float ridge = 0.35f * half;
    const float y = top + 0.3f;
    const float peak = y + 4;
    b.face({-out, y, out}, {out, y, out}, {ridge, peak, 0}, {-ridge, peak, 0}, {8, 4});
    b.face({out, y, -out}, {-out, y, -out}, {-ridge, peak, 0}, {ridge, peak, 0}, {8, 4});
    const std::uint32_t i = b.vertex({out, y, out}, {0.7f, 0.7f, 0});
    b.vertex({out, y, -out}, {0.7f, 0.7f, 0}, {4, 0});
    b.vertex({ridge, peak, 0}, {0.7f, 0.7f, 0}, {2, 4});
    b.triangle(i, i + 1, i + 2);
    const std::uint32_t k = b.vertex({-out, y, -out}, {-0.7f, 0.7f, 0});
    b.vertex({-out, y, out}, {-0.7f, 0.7f, 0}, {4, 0});
    b.vertex({-ridge, peak, 0}, {-0.7f, 0.7f, 0}, {2, 4});
    b.triangle(k, k + 1, k + 2);
    b.face({-out, y, -out}, {out, y, -out}, {out, y, out}, {-out, y, out});
    b.use(m.matte).paint(rgb(0x8a5a48));
    b.box({2, y + 1, -2.6f}, {3, peak + 0.6f, -1.6f});
    return;
  }
  b.use(m.metal).paint(glm::vec3(0.4f));
  for (int i = 0; i < 4; ++i) {
    const float x = random.range(-0.6f, 0.6f) * half;
    const float z = random.range(-0.6f, 0.6f) * half;
    b.rounded_box({x - 1, top, z - 0.8f}, {x + 1, top + random.range(0.9f, 2.0f), z + 0.8f}, 0.08f);
  }
  b.rod({0, top, 0}, {0, top + 4, 0}, 0.06f, 8);
}

}  // namespace

CityMaterials add_city_materials(SceneParts& parts, std::uint32_t seed) {
  CityMaterials m;
  m.wall = parts.add(textured_material(parts.add(paint_mottle(seed, 0.3f, 16)), 0.9f));
  m.glass = parts.add(painted_material(0.12f));
  m.matte = parts.add(painted_material(0.8f));
  m.metal = parts.add(painted_material(0.45f, 0.4f));
  m.paint = parts.add(painted_material(0.25f));
  const LeafStyle leaf{.count = 16,
                       .length = 0.28f,
                       .width = 0.6f,
                       .dark = {0.035f, 0.095f, 0.02f},
                       .light = {0.13f, 0.25f, 0.05f}};
  m.leaves = parts.add(card_material(parts.add(paint_leaf_cluster(seed + 1, leaf))));
  return m;
}

const char* building_name(int kind) { return kStyles[static_cast<std::size_t>(kind)].name; }

Mesh make_building(const CityMaterials& m, int kind, std::uint32_t seed) {
  const Style& s = kStyles[static_cast<std::size_t>(kind)];
  MeshBuilder b;
  Random random(seed, 71);
  const int lower = s.set_back > 0 ? s.set_back : s.floors;
  add_block(b, m, s, s.half, 0, lower, random);
  float half = s.half;
  if (lower < s.floors) {
    half *= 0.72f;
    add_block(b, m, s, half, lower, s.floors, random);
  }
  add_roof(b, m, s, half, s.floor_m * static_cast<float>(s.floors), random);
  b.use(m.matte).paint(rgb(0x4a3526));
  b.box({-0.7f, 0, s.half}, {0.7f, 2.3f, s.half + 0.1f});
  // Streets are dim at the bottom: half the sky is hidden there.
  b.shade(
      [](glm::vec3 p, glm::vec3) { return 0.62f + 0.38f * glm::smoothstep(-1.0f, 14.0f, p.y); });
  return b.take();
}

}  // namespace mirage::builtin
