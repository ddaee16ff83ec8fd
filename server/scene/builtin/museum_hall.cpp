#include "server/scene/builtin/museum_hall.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/scene/builtin/tau.h"
#include "server/scene/builtin/texture_paint.h"

namespace mirage::builtin {
namespace {

constexpr int kSegments = 160;  // of the hall's circle
constexpr float kCornice = 0.35f;
constexpr float kOculus = 0.16f;      // of the hall's radius
constexpr float kDomeHeight = 0.42f;  // of the hall's radius
constexpr float kPillarInset = 1.1f;  // metres from the wall
constexpr std::array<float, 3> kPlinthHeights = {0.3f, 0.6f, 0.95f};
constexpr float kTopOfView = 2.0f;  // metres above the floor; most sculptures end below it

glm::vec3 on_circle(float radius, float y, float angle) {
  return {radius * std::cos(angle), y, radius * std::sin(angle)};
}

glm::vec3 floor_color(const Hall& hall, glm::vec3 p) {
  const float r = glm::length(glm::vec2(p.x, p.z));
  const glm::vec3 pale(0.62f, 0.57f, 0.49f);
  const glm::vec3 dark(0.16f, 0.13f, 0.115f);
  const glm::vec3 carpet(0.24f, 0.045f, 0.045f);
  glm::vec3 c = pale;
  const float off = std::abs(r - hall.loop_radius);
  if (off < 1.15f) c = dark;
  if (off < 1.0f) c = carpet;
  if (off < 0.86f && off > 0.78f) c = glm::vec3(0.5f, 0.34f, 0.12f);
  if (r > hall.radius - 1.9f) c = dark * 1.6f;
  float light = 0.55f + 0.45f * glm::smoothstep(0.0f, 2.5f, hall.radius - r);
  for (const glm::vec3& s : hall.shadows) {
    const float gap = glm::length(glm::vec2(p.x, p.z) - glm::vec2(s)) - s.z;
    if (gap < 0.7f) light *= 0.45f + 0.55f * glm::smoothstep(-0.15f, 0.7f, gap);
  }
  return c * light;
}

void add_floor(SceneParts& parts, const Hall& hall, std::uint32_t seed) {
  MeshBuilder b;
  b.use(parts.add(textured_material(parts.add(paint_mottle(seed, 0.35f, 8)), 0.35f)));
  const auto rings = static_cast<std::uint32_t>(hall.radius * 7);
  constexpr std::uint32_t kRow = 2 * kSegments;
  for (std::uint32_t j = 0; j <= rings; ++j) {
    const float r = hall.radius * static_cast<float>(j) / static_cast<float>(rings);
    for (std::uint32_t s = 0; s < kRow; ++s) {
      const glm::vec3 p = on_circle(r, 0, kTau * static_cast<float>(s) / kRow);
      b.paint(floor_color(hall, p));
      b.vertex(p, {0, 1, 0}, glm::vec2(p.x, p.z) * 0.4f);
    }
  }
  for (std::uint32_t j = 0; j < rings; ++j) {
    for (std::uint32_t s = 0; s < kRow; ++s) {
      const std::uint32_t k = j * kRow + s;
      const std::uint32_t next = j * kRow + (s + 1) % kRow;
      b.quad(k, next, next + kRow, k + kRow);
    }
  }
  parts.put(parts.add("hall floor", b.take()), {0, 0, 0});
}

/// Returns the profile from the oculus down to the floor. It is seen from inside, so its outside is
/// to the right.
std::vector<glm::vec2> shell_profile(const Hall& hall) {
  std::vector<glm::vec2> profile;
  const float dome = hall.radius * kDomeHeight;
  constexpr int kSteps = 24;
  for (int i = 0; i <= kSteps; ++i) {
    const float from = std::asin(kOculus);
    const float a = from + (0.25f * kTau - from) * static_cast<float>(i) / kSteps;
    profile.emplace_back(hall.radius * std::sin(a), hall.wall_height + dome * std::cos(a));
  }
  const float r = hall.radius, h = hall.wall_height;
  for (const glm::vec2 p : {glm::vec2(r - kCornice, h), glm::vec2(r - kCornice, h - 0.18f),
                            glm::vec2(r - 0.16f, h - 0.5f), glm::vec2(r - 0.12f, h - 0.62f)}) {
    profile.push_back(p);
  }
  for (int i = 0; i <= 12; ++i) {
    profile.emplace_back(r, glm::mix(h - 0.62f, 1.12f, static_cast<float>(i) / 12));
  }
  for (const glm::vec2 p :
       {glm::vec2(r - 0.06f, 1.1f), glm::vec2(r - 0.06f, 1.0f), glm::vec2(r - 0.02f, 0.97f),
        glm::vec2(r - 0.02f, 0.22f), glm::vec2(r - 0.07f, 0.2f), glm::vec2(r - 0.07f, 0.0f)}) {
    profile.push_back(p);
  }
  return profile;
}

glm::vec3 shell_color(const Hall& hall, glm::vec3 p) {
  const float h = hall.wall_height;
  if (p.y > h + 0.01f) {
    // Coffers, darker in their middle, in rings up the dome.
    const float up = (p.y - h) / (hall.radius * kDomeHeight);
    const float ring = glm::fract(std::asin(glm::clamp(up, 0.0f, 1.0f)) * 4.2f);
    const float sector = glm::fract(std::atan2(p.z, p.x) / kTau * 32 + 0.25f);
    const float coffer = glm::smoothstep(0.12f, 0.2f, std::min(ring, 1 - ring)) *
                         glm::smoothstep(0.12f, 0.2f, std::min(sector, 1 - sector));
    return glm::vec3(0.72f, 0.69f, 0.63f) * (1 - 0.38f * coffer) * (0.6f + 0.4f * up);
  }
  if (p.y > h - 0.65f) return glm::vec3(0.68f, 0.62f, 0.5f);
  if (p.y < 0.21f) return glm::vec3(0.12f, 0.1f, 0.09f);
  if (p.y < 1.11f) return glm::vec3(0.3f, 0.2f, 0.13f);
  // Lamps below the cornice wash the wall between the pillars.
  const float sector = glm::fract(std::atan2(p.z, p.x) / kTau * 16);
  const float wash = std::exp(-20 * (sector - 0.5f) * (sector - 0.5f));
  const float fall = glm::smoothstep(0.6f, h, p.y);
  return glm::vec3(0.23f, 0.36f, 0.33f) * (0.62f + 0.38f * wash * (0.4f + 0.6f * fall));
}

void add_shell(SceneParts& parts, const Hall& hall, std::uint32_t seed) {
  MeshBuilder b;
  b.use(parts.add(textured_material(parts.add(paint_mottle(seed + 3, 0.18f, 16)), 0.9f)));
  b.lathe(shell_profile(hall), kSegments);
  for (Vertex& v : b.vertices()) {
    v.uv0 = {v.uv0.x * std::round(hall.radius * 2), v.position.y * 0.4f};
    const glm::vec3 c = shell_color(hall, v.position);
    v.color = glm::u16vec4(glm::u16vec3(c * 65535.0f), 65535);
  }
  b.use(parts.add(glowing_material({1.1f, 1.2f, 1.35f})));
  const float top = hall.wall_height + hall.radius * kDomeHeight * std::sqrt(1 - kOculus * kOculus);
  const std::uint32_t middle = b.vertex({0, top, 0}, {0, -1, 0});
  for (std::uint32_t s = 0; s < kSegments; ++s) {
    b.vertex(on_circle(hall.radius * kOculus, top, kTau * static_cast<float>(s) / kSegments),
             {0, -1, 0});
  }
  for (std::uint32_t s = 0; s < kSegments; ++s) {
    b.triangle(middle, middle + 1 + s, middle + 1 + (s + 1) % kSegments);
  }
  parts.put(parts.add("hall", b.take()), {0, 0, 0});
}

void add_pillars(SceneParts& parts, const Hall& hall, std::uint32_t stone) {
  MeshBuilder b;
  b.use(stone).paint({0.66f, 0.62f, 0.55f});
  b.box({-0.42f, 0, -0.42f}, {0.42f, 0.25f, 0.42f});
  const float h = hall.wall_height - 0.5f;
  const std::vector<glm::vec2> shaft = {{0, 0.25f},        {0.4f, 0.25f},    {0.42f, 0.33f},
                                        {0.36f, 0.42f},    {0.31f, 0.5f},    {0.32f, 0.4f * h},
                                        {0.27f, h - 0.6f}, {0.3f, h - 0.5f}, {0.36f, h - 0.3f},
                                        {0.44f, h - 0.2f}, {0, h - 0.2f}};
  const std::uint32_t first = b.vertex_count();
  b.lathe(shaft, 72);
  // Flutes, as light and shade.
  for (std::size_t i = first; i < b.vertices().size(); ++i) {
    Vertex& v = b.vertices()[i];
    if (v.position.y < 0.45f || v.position.y > h - 0.55f) continue;
    const float flute = 0.8f + 0.2f * std::cos(18 * std::atan2(v.position.z, v.position.x));
    v.color = glm::u16vec4(glm::vec4(glm::vec3(v.color) * flute, 65535));
  }
  b.box({-0.46f, h - 0.2f, -0.46f}, {0.46f, h + 0.5f, 0.46f});
  const std::uint32_t pillar = parts.add("pillar", b.take());
  constexpr int kPillars = 16;
  for (int i = 0; i < kPillars; ++i) {
    const float a = kTau * static_cast<float>(i) / kPillars;
    const glm::vec3 p = on_circle(hall.radius - kPillarInset, 0, a);
    parts.put(pillar, {p.x, 0, p.z}, -a);
  }
}

void add_pictures(SceneParts& parts, const Hall& hall, std::uint32_t seed) {
  const std::uint32_t frame = parts.add(painted_material(0.4f, 0.6f));
  constexpr std::uint32_t kPictures = 8;
  std::array<std::uint32_t, kPictures> pictures{};
  Random random(seed, 121);
  for (std::uint32_t i = 0; i < kPictures; ++i) {
    MeshBuilder b;
    const float w = random.range(0.7f, 1.2f), h = random.range(0.6f, 1.0f);
    b.use(frame).paint(rgb(0xb08a45));
    b.box({-w - 0.12f, -h - 0.12f, -0.05f}, {w + 0.12f, h + 0.12f, 0.03f});
    b.use(parts.add(textured_material(parts.add(paint_picture(seed + 40 + i)), 0.6f)));
    b.paint(glm::vec3(1));
    b.face({-w, h, 0.035f}, {-w, -h, 0.035f}, {w, -h, 0.035f}, {w, h, 0.035f});
    // The face's v runs from its first corner to its last.
    for (std::size_t k = b.vertices().size() - 4; k < b.vertices().size(); ++k) {
      Vertex& v = b.vertices()[k];
      v.uv0 = {v.position.x > 0 ? 1.0f : 0.0f, v.position.y > 0 ? 0.0f : 1.0f};
    }
    pictures[i] = parts.add("picture", b.take());
  }
  for (std::uint32_t i = 0; i < 16; ++i) {
    const float a = kTau * (static_cast<float>(i) + 0.5f) / 16;
    const glm::vec3 p = on_circle(hall.radius - 0.1f, 2.6f, a);
    parts.put(pictures[i % kPictures], p, -a - 0.25f * kTau);
  }
}

}  // namespace

Plinths::Plinths(SceneParts& parts, std::uint32_t seed) {
  const std::int32_t mottle = parts.add(paint_mottle(seed + 6, 0.25f, 12));
  const std::uint32_t stone = parts.add(textured_material(mottle, 0.55f));
  constexpr float kHalf = 0.55f;  // its corners stay within kPlinthRadius
  for (const float h : kPlinthHeights) {
    MeshBuilder b;
    b.use(stone).paint(glm::vec3(0.68f, 0.66f, 0.62f));
    b.box({-kHalf, 0, -kHalf}, {kHalf, 0.08f, kHalf});
    b.rounded_box({-kHalf + 0.04f, 0.02f, -kHalf + 0.04f}, {kHalf - 0.04f, h, kHalf - 0.04f},
                  0.015f, 2);
    square_.push_back({parts.add("plinth", b.take()), h});
    b.use(stone).paint(glm::vec3(0.2f, 0.19f, 0.185f));
    const std::vector<glm::vec2> turned = {
        {0, 0},     {0.68f, 0}, {0.68f, 0.07f}, {0.6f, 0.1f}, {0.6f, h - 0.08f}, {0.66f, h - 0.06f},
        {0.66f, h}, {0, h}};
    b.lathe(turned, 64);
    round_.push_back({parts.add("round plinth", b.take()), h});
  }
}

const Plinth& Plinths::under(float sculpture_height, bool round) const {
  const std::vector<Plinth>& kinds = round ? round_ : square_;
  return *std::min_element(kinds.begin(), kinds.end(), [&](const Plinth& a, const Plinth& b) {
    const auto off = [&](const Plinth& p) {
      return std::abs(p.height + sculpture_height - kTopOfView);
    };
    return off(a) < off(b);
  });
}

void add_hall(SceneParts& parts, const Hall& hall, std::uint32_t seed) {
  add_floor(parts, hall, seed);
  add_shell(parts, hall, seed);
  add_pillars(parts, hall,
              parts.add(textured_material(parts.add(paint_mottle(seed + 9, 0.2f, 8)), 0.6f)));
  add_pictures(parts, hall, seed);
}

}  // namespace mirage::builtin
