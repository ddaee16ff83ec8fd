// Sculptures turned about the y axis, and stones: one radius for each direction.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "server/scene/builtin/random.h"
#include "server/scene/builtin/sculpture_forms.h"
#include "server/scene/builtin/tau.h"

namespace mirage::builtin {
namespace {

template <typename Point>
Point catmull_rom(const std::vector<Point>& points, float t) {
  const auto last = static_cast<int>(points.size()) - 1;
  const float x = glm::clamp(t, 0.0f, 1.0f) * static_cast<float>(last);
  const int i = std::min(static_cast<int>(x), last - 1);
  const auto at = [&](int k) { return points[static_cast<std::size_t>(std::clamp(k, 0, last))]; };
  const float f = x - static_cast<float>(i);
  const Point a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
  return b +
         0.5f * f *
             ((c - a) + f * ((2.0f * a - 5.0f * b + 4.0f * c - d) + f * (3.0f * (b - c) + d - a)));
}

glm::vec3 around(float radius, float y, float angle) {
  return {radius * std::cos(angle), y, radius * std::sin(angle)};
}

glm::vec3 direction(float u, float v) {
  const float polar = v * 0.5f * kTau;
  return around(v <= 0 || v >= 1 ? 0.0f : std::sin(polar), -std::cos(polar), u * kTau);
}

/// Returns 1 between low and high, fading over `soft`.
float band(float x, float low, float high, float soft) {
  return glm::smoothstep(low - soft, low + soft, x) *
         (1 - glm::smoothstep(high - soft, high + soft, x));
}

/// Returns carved lines: 1 in the middle of a groove.
float grooves(glm::vec3 p, std::uint32_t seed) {
  const float n = 2 * fractal_noise(p, seed) - 1;
  return std::exp(-60 * n * n);
}

}  // namespace

SculptureShape shape_urn(std::uint32_t seed) {
  Random random(seed, 81);
  const float foot = random.range(0.16f, 0.24f);
  const float stem = random.range(0.08f, 0.16f);
  const float belly = random.range(0.3f, 0.46f);
  const float shoulder = belly * random.range(0.7f, 1.0f);
  const float neck = random.range(0.12f, 0.2f);
  const float lip = neck * random.range(1.3f, 1.9f);
  // The profile goes up the outside, over the lip and down the inside.
  const std::vector<glm::vec2> profile = {{0, 0},
                                          {foot, 0},
                                          {foot, 0.05f},
                                          {stem, 0.16f},
                                          {belly, 0.42f},
                                          {shoulder, 0.7f},
                                          {neck, 0.88f},
                                          {lip, 1.0f},
                                          {lip * 0.9f, 1.02f},
                                          {neck * 0.8f, 0.9f},
                                          {shoulder * 0.8f, 0.7f},
                                          {0, 0.55f}};
  const auto flutes = static_cast<float>(12 + 2 * random.index(10));
  const float slant = random.chance(0.5f) ? random.range(-2.0f, 2.0f) : 0.0f;
  const float deep = random.range(0.012f, 0.03f);
  GridSurface s;
  s.aspect = 1.1f;
  s.texture_repeats = {2, 2};
  s.at = [=](float u, float v) {
    const glm::vec2 p = catmull_rom(profile, v);
    const float angle = u * kTau;
    const float flute = std::abs(std::sin(0.5f * (flutes * angle + slant * kTau * p.y)));
    const bool outside = v < 0.62f;
    float relief = outside ? deep * flute * band(p.y, 0.22f, 0.5f, 0.03f) : 0.0f;
    const float frieze = outside ? band(p.y, 0.56f, 0.7f, 0.012f) : 0.0f;
    if (frieze > 0) relief -= 0.018f * frieze * grooves(around(1.6f, 7 * p.y, angle), seed);
    relief += 0.004f * fractal_noise(around(9 * p.x, 9 * p.y, angle), seed + 3);
    const float r =
        v <= 0 || v >= 1 ? 0.0f : std::max(0.0f, p.x + relief * std::min(1.0f, 20 * p.x));
    return around(r, p.y, angle);
  };
  return s;
}

SculptureShape shape_twisted_column(std::uint32_t seed) {
  Random random(seed, 82);
  const float low_sides = static_cast<float>(3 + random.index(3));
  const float high_sides = static_cast<float>(4 + random.index(4));
  const float turns = random.range(0.3f, 1.4f) * (random.chance(0.5f) ? 1.0f : -1.0f);
  const float swell = random.range(-0.06f, 0.09f);
  const float strands = static_cast<float>(5 + random.index(6));
  GridSurface s;
  s.aspect = 0.8f;
  s.texture_repeats = {1, 3};
  s.at = [=](float u, float v) {
    const float cap = 0.04f;
    const float y = glm::clamp((v - cap) / (1 - 2 * cap), 0.0f, 1.0f);
    const float closing = std::min(1.0f, std::min(v, 1 - v) / cap);
    const float angle = u * kTau;
    const float lobes = glm::mix(std::cos(low_sides * angle), std::cos(high_sides * angle),
                                 glm::smoothstep(0.2f, 0.8f, y));
    const float rope = std::abs(std::sin(0.5f * strands * (angle + 2 * turns * kTau * y)));
    float r = 0.2f + 0.055f * lobes + swell * std::sin(0.5f * kTau * y) + 0.02f * rope - 0.05f * y;
    r += 0.012f * fractal_noise(around(4, 14 * y, angle), seed);
    const float slab = std::max(band(y, -1, 0.03f, 0.004f), band(y, 0.97f, 2, 0.004f));
    r = glm::mix(r, 0.29f, slab);
    return around(closing <= 0 ? 0.0f : r * closing, 1.6f * y, angle + turns * kTau * y);
  };
  return s;
}

SculptureShape shape_cut_stone(std::uint32_t seed) {
  Random random(seed, 83);
  struct Cut {
    glm::vec3 normal;
    float distance;
  };
  std::vector<Cut> cuts = {{{0, -1, 0}, 0.62f}};
  const std::uint32_t count = 12 + random.index(14);
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 n = random.direction();
    cuts.push_back({n, random.range(0.62f, 0.8f)});
  }
  const glm::vec3 stretch{random.range(0.7f, 0.95f), random.range(0.95f, 1.35f),
                          random.range(0.7f, 0.95f)};
  const float rough = random.range(0.004f, 0.02f);
  const float carved = random.chance(0.6f) ? random.range(0.01f, 0.025f) : 0.0f;
  GridSurface s;
  s.aspect = 2;
  s.texture_repeats = {2, 1};
  s.at = [=](float u, float v) {
    const glm::vec3 d = direction(u, v);
    // A soft minimum rounds the edges between the faces.
    float sum = 0;
    for (const Cut& cut : cuts) {
      const float facing = glm::dot(d, cut.normal);
      if (facing > 0.05f) sum += std::exp(-36 * (cut.distance / facing));
    }
    float r = -std::log(std::max(sum, 1e-30f)) / 36;
    r += rough * (fractal_noise(d * 6.0f, seed) + 0.5f * fractal_noise(d * 30.0f, seed + 5));
    if (carved > 0) r -= carved * grooves(d * 1.7f, seed + 9);
    return d * r * stretch;
  };
  return s;
}

SculptureShape shape_coral(std::uint32_t seed) {
  Random random(seed, 84);
  const float scale = random.range(2.2f, 4.0f);
  const float depth = random.range(0.16f, 0.3f);
  const glm::vec3 stretch{random.range(0.75f, 1.0f), random.range(0.9f, 1.3f),
                          random.range(0.75f, 1.0f)};
  GridSurface s;
  s.aspect = 2;
  s.texture_repeats = {2, 1};
  s.at = [=](float u, float v) {
    const glm::vec3 d = direction(u, v);
    const glm::vec3 warp(value_noise(d * 2.5f, seed), value_noise(d * 2.5f + 7.0f, seed),
                         value_noise(d * 2.5f + 13.0f, seed));
    const float n = 2 * value_noise((d + 0.5f * warp) * scale, seed + 3) - 1;
    const float fine = fractal_noise(d * 18.0f, seed + 8);
    const float brain = 1 - std::exp(-10 * n * n);
    return d * (0.62f + depth * brain + 0.03f * fine) * stretch;
  };
  return s;
}

}  // namespace mirage::builtin
