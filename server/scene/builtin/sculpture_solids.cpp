// Sculptures built of solids that flow into each other. Their distances follow Quilez, "Distance
// functions" (2008): ellipsoids are approximate, smooth minima are polynomial.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "server/scene/builtin/random.h"
#include "server/scene/builtin/sculpture_forms.h"

namespace mirage::builtin {
namespace {

float smooth_min(float a, float b, float soft) {
  const float h = std::max(soft - std::abs(a - b), 0.0f) / soft;
  return std::min(a, b) - h * h * soft * 0.25f;
}
float smooth_max(float a, float b, float soft) { return -smooth_min(-a, -b, soft); }

float ellipsoid(glm::vec3 p, glm::vec3 radii) {
  const glm::vec3 q = p / radii;
  const float near = glm::length(q);
  const float steep = glm::length(q / radii);
  return steep > 1e-6f ? near * (near - 1) / steep : -std::min(radii.x, std::min(radii.y, radii.z));
}

float capsule(glm::vec3 p, glm::vec3 a, glm::vec3 b, float radius) {
  const glm::vec3 ab = b - a;
  const float t = glm::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0f, 1.0f);
  return glm::length(p - a - ab * t) - radius;
}

float box(glm::vec3 p, glm::vec3 half, float round) {
  const glm::vec3 q = glm::abs(p) - half + round;
  return glm::length(glm::max(q, 0.0f)) + std::min(std::max(q.x, std::max(q.y, q.z)), 0.0f) - round;
}

float disc(glm::vec3 p, float radius, float half_height, float round) {
  const glm::vec2 q = glm::vec2(glm::length(glm::vec2(p.x, p.z)), std::abs(p.y)) -
                      glm::vec2(radius - round, half_height - round);
  return glm::length(glm::max(q, 0.0f)) + std::min(std::max(q.x, q.y), 0.0f) - round;
}

float torus(glm::vec3 p, float radius, float tube) {
  return glm::length(glm::vec2(glm::length(glm::vec2(p.x, p.z)) - radius, p.y)) - tube;
}

/// True if carving can be visible at this distance. Carving is slow to compute and nowhere this
/// deep.
bool near(float distance) { return std::abs(distance) < 0.07f; }

/// Parameters by which heads of one family differ.
struct Face {
  float long_head, wide_head, nose, jaw, hair, curl, cheek, worn, tilt;
};

float bust_hair(glm::vec3 p, const Face& f, std::uint32_t seed) {
  const float cap =
      ellipsoid(p - glm::vec3(-0.04f, 0.05f, 0), {0.31f, 0.38f * f.long_head, 0.26f * f.wide_head});
  // Combed back from a hairline above the brow.
  const float hairline = p.x * 0.75f - p.y * 0.65f - f.hair;
  if (!near(cap)) return smooth_max(cap - 0.022f, hairline, 0.03f);
  const float wave = std::sin(f.curl * (p.y + 0.7f * p.x) * 26 + 7 * fractal_noise(p * 5.0f, seed));
  return smooth_max(cap - 0.022f - 0.012f * wave, hairline, 0.03f);
}

float bust_head(glm::vec3 p, const Face& f) {
  glm::vec3 m(p.x, p.y, std::abs(p.z));  // both halves at once
  const float flow = 0.06f;
  float d = ellipsoid(p, {0.29f, 0.37f * f.long_head, 0.245f * f.wide_head});
  d = smooth_min(d, ellipsoid(p - glm::vec3(0.09f, -0.2f, 0), {0.19f, 0.19f, 0.16f * f.jaw}),
                 0.12f);
  d = smooth_min(d, ellipsoid(p - glm::vec3(0.23f, -0.35f, 0), {0.05f, 0.045f, 0.06f * f.jaw}),
                 flow);
  d = smooth_min(d, ellipsoid(m - glm::vec3(0.2f, -0.11f, 0.12f), glm::vec3(0.07f * f.cheek)),
                 flow);
  d = smooth_min(d, capsule(m, {0.27f, 0.075f, 0.03f}, {0.22f, 0.07f, 0.15f}, 0.032f), 0.04f);
  d = smooth_max(d, -ellipsoid(m - glm::vec3(0.3f, 0.01f, 0.1f), {0.06f, 0.045f, 0.06f}), 0.04f);
  d = smooth_min(d, ellipsoid(m - glm::vec3(0.235f, 0.005f, 0.1f), {0.035f, 0.03f, 0.05f}), 0.012f);
  const glm::vec3 tip(0.3f + f.nose, -0.11f, 0);
  d = smooth_min(d, capsule(p, {0.275f, 0.05f, 0}, tip, 0.026f), 0.035f);
  d = smooth_min(d, ellipsoid(m - tip + glm::vec3(0.025f, 0.005f, -0.03f), glm::vec3(0.026f)),
                 0.02f);
  d = smooth_min(d, ellipsoid(p - glm::vec3(0.27f, -0.205f, 0), {0.035f, 0.018f, 0.07f}), 0.02f);
  d = smooth_min(d, ellipsoid(p - glm::vec3(0.265f, -0.245f, 0), {0.035f, 0.02f, 0.06f}), 0.02f);
  return smooth_min(
      d, ellipsoid(m - glm::vec3(-0.01f, -0.03f, 0.25f * f.wide_head), {0.05f, 0.085f, 0.025f}),
      0.02f);
}

float bust(glm::vec3 p, const Face& f, std::uint32_t seed) {
  const glm::vec3 head = p - glm::vec3(0.02f, 0.5f, 0);
  const float c = std::cos(f.tilt), s = std::sin(f.tilt);
  const glm::vec3 turned(c * head.x - s * head.z, head.y, s * head.x + c * head.z);
  // Far from the head, a ball about it is accurate enough.
  float d = glm::length(head) - 0.46f;
  if (d < 0.15f) d = smooth_min(bust_head(turned, f), bust_hair(turned, f, seed), 0.015f);
  d = smooth_min(d, capsule(p, {-0.04f, 0.3f, 0}, {-0.07f, -0.1f, 0}, 0.14f), 0.08f);
  float torso = ellipsoid(p - glm::vec3(-0.07f, -0.3f, 0), {0.2f, 0.17f, 0.47f});
  torso =
      smooth_min(torso, ellipsoid(p - glm::vec3(-0.03f, -0.42f, 0), {0.23f, 0.3f, 0.34f}), 0.12f);
  // A garment's folds, and the cut below it.
  if (near(torso)) {
    const float folds =
        std::sin(34 * (p.y + 0.6f * std::abs(p.z)) + 6 * fractal_noise(p * 3.0f, seed + 5));
    torso -= 0.012f * folds * glm::smoothstep(-0.1f, -0.3f, p.y);
  }
  torso = smooth_max(torso, -p.y - 0.62f, 0.03f);
  d = smooth_min(d, torso, 0.1f);
  d = smooth_min(d, disc(p - glm::vec3(-0.04f, -0.75f, 0), 0.13f, 0.16f, 0.02f), 0.04f);
  d = smooth_min(d, disc(p - glm::vec3(-0.04f, -0.9f, 0), 0.24f, 0.05f, 0.015f), 0.015f);
  if (!near(d)) return d;
  return d - f.worn * (fractal_noise(p * 14.0f, seed + 9) - 0.5f);
}

struct Limb {
  glm::vec3 from, to;
  float radius;
};

enum class Block { kBox, kBall, kRing, kDisc, kSpindle };

struct TotemPart {
  Block block;
  float y, height, radius, turn;
};

float totem_part(glm::vec3 p, const TotemPart& part) {
  const float half = 0.5f * part.height;
  const float away = std::abs(p.y - part.y) - 1.2f * half;
  if (away > 0.1f) return away;
  const float c = std::cos(part.turn), s = std::sin(part.turn);
  const glm::vec3 q(c * p.x - s * p.z, p.y - part.y, s * p.x + c * p.z);
  switch (part.block) {
    case Block::kBox:
      return box(q, {part.radius * 0.85f, half, part.radius * 0.85f}, 0.03f);
    case Block::kBall:
      return ellipsoid(q, {part.radius, half * 1.1f, part.radius});
    case Block::kRing:
      return torus(glm::vec3(q.x, q.z, q.y), half * 0.72f, half * 0.3f);
    case Block::kDisc:
      return disc(q, part.radius * 1.1f, half, 0.04f);
    case Block::kSpindle:
      return box(q, {part.radius * 0.5f, half * 1.1f, part.radius * 0.95f}, 0.12f);
  }
  return 1;
}

}  // namespace

SculptureShape shape_bust(std::uint32_t seed) {
  Random random(seed, 101);
  Face f{};
  f.long_head = random.range(0.92f, 1.1f);
  f.wide_head = random.range(0.9f, 1.1f);
  f.nose = random.range(0.03f, 0.08f);
  f.jaw = random.range(0.85f, 1.25f);
  f.hair = random.range(-0.12f, 0.02f);
  f.curl = random.range(0.5f, 2.5f);
  f.cheek = random.range(0.8f, 1.2f);
  f.worn = random.range(0.004f, 0.02f);
  f.tilt = random.range(-0.5f, 0.5f);
  Solid s;
  s.half_extent = {0.55f, 1.0f, 0.62f};
  s.texture_repeats = {1, 1.5f};
  s.distance = [=](glm::vec3 p) { return bust(p, f, seed); };
  return s;
}

SculptureShape shape_reclining(std::uint32_t seed) {
  Random random(seed, 102);
  std::vector<Limb> limbs;
  glm::vec3 at(-0.62f, random.range(-0.3f, -0.1f), 0);
  const std::uint32_t joints = 5 + random.index(4);
  for (std::uint32_t i = 0; i < joints; ++i) {
    const float x = -0.62f + 1.24f * static_cast<float>(i + 1) / static_cast<float>(joints);
    const glm::vec3 to{x, (i % 2 == 0 ? 1.0f : -1.0f) * random.range(0.1f, 0.42f),
                       random.range(-0.3f, 0.3f)};
    limbs.push_back({at, to, random.range(0.1f, 0.2f)});
    at = to;
  }
  const glm::vec3 head = at + glm::vec3(-0.05f, 0.22f, 0);
  std::array<glm::vec4, 3> holes;
  for (glm::vec4& hole : holes) {
    hole = {random.range(-0.45f, 0.45f), random.range(-0.2f, 0.2f), random.range(-0.1f, 0.1f),
            random.range(0.07f, 0.14f)};
  }
  const float chisel = random.range(0.0f, 0.012f);
  Solid s;
  s.half_extent = {0.95f, 0.75f, 0.6f};
  s.texture_repeats = {1, 1};
  s.distance = [=](glm::vec3 p) {
    float d = ellipsoid(p - head, {0.12f, 0.15f, 0.11f});
    for (const Limb& limb : limbs) {
      d = smooth_min(d, capsule(p, limb.from, limb.to, limb.radius), 0.2f);
    }
    d = smooth_min(d, box(p - glm::vec3(0, -0.56f, 0), {0.72f, 0.07f, 0.36f}, 0.03f), 0.08f);
    for (const glm::vec4& hole : holes) {
      const glm::vec3 q = p - glm::vec3(hole);
      d = smooth_max(d, hole.w - glm::length(glm::vec2(q.x, q.y)) + 0.6f * std::abs(q.z) * hole.w,
                     0.08f);
    }
    if (!near(d)) return d;
    return d - chisel * std::sin(60 * fractal_noise(p * 2.5f, seed)) * 0.5f;
  };
  return s;
}

SculptureShape shape_lattice(std::uint32_t seed) {
  Random random(seed, 103);
  const float cells = random.range(7, 12);
  const float wall = random.range(0.4f, 0.75f);
  const float egg = random.range(0.0f, 0.25f);
  const bool diamond = random.chance(0.4f);
  const float turn = random.range(0.0f, 1.5f);
  Solid s;
  s.half_extent = {0.75f, 1.0f, 0.75f};
  s.texture_repeats = {1, 1};
  s.distance = [=](glm::vec3 p) {
    const glm::vec3 radii =
        glm::vec3(0.68f, 0.95f, 0.68f) * glm::vec3(1 - egg * p.y, 1, 1 - egg * p.y);
    const float hull = ellipsoid(p, radii);
    if (hull > 0.2f) return hull;
    const float c = std::cos(turn * p.y), sn = std::sin(turn * p.y);
    const glm::vec3 q = glm::vec3(c * p.x - sn * p.z, p.y, sn * p.x + c * p.z) * cells;
    const glm::vec3 a = glm::sin(q), b = glm::cos(q);
    const float field = diamond ? 0.8f * (b.x + b.y + b.z) : a.x * b.y + a.y * b.z + a.z * b.x;
    // The slope of a gyroid is at most about 1.5 for each radian.
    const float sheet = (std::abs(field) - wall) / (1.5f * cells);
    const float core = glm::length(p / glm::vec3(0.4f, 0.55f, 0.4f)) - 1;
    return smooth_min(smooth_max(hull, sheet, 0.02f), 0.35f * core, 0.04f);
  };
  return s;
}

SculptureShape shape_totem(std::uint32_t seed) {
  Random random(seed, 104);
  std::vector<TotemPart> parts = {{Block::kDisc, -0.93f, 0.12f, 0.3f, 0}};
  float y = -0.87f;
  while (y < 0.7f) {
    TotemPart part;
    part.block = static_cast<Block>(random.index(5));
    part.height = std::min(random.range(0.28f, 0.5f), 0.98f - y);
    part.radius = random.range(0.2f, 0.32f);
    part.turn = random.angle();
    part.y = y + 0.5f * part.height;
    parts.push_back(part);
    y += part.height * 0.96f;
  }
  const float lines = random.range(40, 90);
  const float carved = random.range(0.004f, 0.01f);
  Solid s;
  s.half_extent = {0.45f, 1.0f, 0.45f};
  s.texture_repeats = {1, 2};
  s.distance = [=](glm::vec3 p) {
    float d = 1e9f;
    for (const TotemPart& part : parts) d = smooth_min(d, totem_part(p, part), 0.035f);
    if (!near(d)) return d;
    const float groove = std::abs(std::sin(lines * p.y + 5 * fractal_noise(p * 2.0f, seed)));
    return d + carved * glm::smoothstep(0.25f, 0.0f, groove) -
           0.004f * fractal_noise(p * 16.0f, seed + 4);
  };
  return s;
}

}  // namespace mirage::builtin
