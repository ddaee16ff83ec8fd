#include "server/scene/builtin/sculpture_paint.h"

#include <array>
#include <cmath>
#include <vector>

#include "server/scene/builtin/mesh_builder.h"
#include "server/scene/builtin/random.h"
#include "server/scene/builtin/tau.h"
#include "server/scene/builtin/texture_paint.h"

namespace mirage::builtin {
namespace {

struct Texel {
  glm::vec3 color{1};  // linear
  float height = 0;    // in texels of an image 512 pixels wide
  float roughness = 0.5f;
  float metallic = 0;
};

/// Three colours that a finish is mixed from.
struct Palette {
  glm::vec3 base, second, third;
};

float tiled(glm::vec2 uv, int cells, std::uint32_t seed) {
  return value_noise(uv * static_cast<float>(cells), seed, cells);
}
float fractal(glm::vec2 uv, int cells, std::uint32_t seed) {
  return fractal_noise(uv * static_cast<float>(cells), seed, cells);
}
/// Returns 1 where the noise crosses its middle, falling off beside it.
float line_at_half(float noise, float sharpness) {
  const float d = 2 * noise - 1;
  return std::exp(-sharpness * d * d);
}

Texel marble(glm::vec2 uv, const Palette& p, std::uint32_t seed) {
  const float warp = fractal(uv, 4, seed);
  const glm::vec2 bent = uv + glm::vec2(0.35f, 0.2f) * warp;
  const float broad = line_at_half(fractal(bent, 3, seed + 10), 40);
  const float thin = line_at_half(fractal(bent, 7, seed + 20), 160);
  Texel t;
  t.color = glm::mix(p.base * (0.85f + 0.25f * warp), p.second, 0.55f * broad);
  t.color = glm::mix(t.color, p.third, 0.7f * thin);
  t.roughness = 0.32f;
  return t;
}

Texel granite(glm::vec2 uv, const Palette& p, std::uint32_t seed) {
  const float coarse = tiled(uv, 90, seed);
  const float fine = tiled(uv, 170, seed + 1);
  Texel t;
  t.color = p.base * (0.75f + 0.5f * fractal(uv, 8, seed + 2));
  t.color = glm::mix(t.color, p.second, glm::smoothstep(0.58f, 0.7f, coarse));
  t.color = glm::mix(t.color, p.third, glm::smoothstep(0.66f, 0.78f, fine));
  t.height = 0.8f * fine;
  t.roughness = 0.6f;
  return t;
}

Texel bronze(glm::vec2 uv, const Palette& p, std::uint32_t seed) {
  const float patina = glm::smoothstep(
      0.47f, 0.66f, 0.75f * fractal(uv, 5, seed) + 0.25f * fractal(uv, 24, seed + 4));
  Texel t;
  t.color = glm::mix(p.base * (0.8f + 0.4f * tiled(uv, 12, seed + 9)), p.second, patina);
  t.height = 1.6f * tiled(uv, 26, seed + 7) + 0.8f * patina * tiled(uv, 120, seed + 8);
  t.roughness = glm::mix(0.34f, 0.85f, patina);
  t.metallic = 1 - 0.9f * patina;
  return t;
}

Texel terracotta(glm::vec2 uv, const Palette& p, std::uint32_t seed) {
  const float clay = fractal(uv, 16, seed);
  // A frieze: key pattern between two lines, worn off in places.
  const float y = glm::fract(uv.y * 3);
  const float x = glm::fract(uv.x * 12);
  const bool line = std::abs(y - 0.2f) < 0.02f || std::abs(y - 0.5f) < 0.02f;
  const bool between = y > 0.25f && y < 0.45f;
  const bool key = between && (x < 0.16f || (x < 0.75f && (y < 0.29f)) ||
                               (x > 0.62f && x < 0.78f && y < 0.41f) ||
                               (x > 0.36f && x < 0.78f && y > 0.37f && y < 0.41f));
  const float paint = (line || key) && fractal(uv, 9, seed + 30) > 0.36f ? 0.85f : 0.0f;
  Texel t;
  t.color = glm::mix(p.base * (0.7f + 0.55f * clay), p.second, paint);
  t.height = 1.5f * clay + 0.5f * paint;
  t.roughness = 0.85f - 0.25f * paint;
  return t;
}

Texel glaze(glm::vec2 uv, const Palette& p, std::uint32_t seed) {
  const glm::vec2 cell(uv.x * 8, uv.y * 6);
  const glm::vec2 q = glm::fract(cell) - 0.5f;
  const float angle = std::atan2(q.y, q.x);
  const float petals = 0.3f + 0.12f * std::cos(5 * angle + static_cast<float>(seed % 7));
  const float flower = glm::smoothstep(0.02f, -0.02f, glm::length(q) - petals);
  const float heart = glm::smoothstep(0.02f, -0.02f, glm::length(q) - 0.1f);
  const float pooled = fractal(uv, 6, seed);
  Texel t;
  t.color = glm::mix(p.base * (0.8f + 0.3f * pooled), p.second, 0.9f * flower);
  t.color = glm::mix(t.color, p.third, heart);
  // Fine cracks.
  t.color *= 1 - 0.4f * line_at_half(fractal(uv, 20, seed + 3), 500);
  t.height = 1.2f * flower + 0.6f * pooled;
  t.roughness = 0.14f;
  return t;
}

Texel wood(glm::vec2 uv, const Palette& p, std::uint32_t seed) {
  const float bend = fractal(uv, 3, seed);
  const float ring = 0.5f + 0.5f * std::sin(kTau * (7 * uv.x + 2.5f * bend));
  const float grain = value_noise(uv * glm::vec2(192, 12), seed + 2, 12);
  Texel t;
  t.color = glm::mix(p.base, p.second, 0.7f * ring + 0.2f * grain) * (0.8f + 0.25f * bend);
  t.height = 1.2f * grain + 0.8f * ring;
  t.roughness = 0.55f;
  return t;
}

Texel sandstone(glm::vec2 uv, const Palette& p, std::uint32_t seed) {
  const float bend = fractal(uv, 3, seed);
  const float layer = 0.5f + 0.5f * std::sin(kTau * (5 * uv.y + 1.6f * bend));
  const float thin = 0.5f + 0.5f * std::sin(kTau * (23 * uv.y + 3.0f * bend));
  const float grain = tiled(uv, 200, seed + 1);
  Texel t;
  t.color = glm::mix(p.base, p.second, 0.75f * layer + 0.2f * thin) * (0.8f + 0.3f * grain);
  t.height = 1.2f * grain + 1.5f * thin;
  t.roughness = 0.92f;
  return t;
}

Texel gilding(glm::vec2 uv, const Palette& p, std::uint32_t seed) {
  const float worn = glm::smoothstep(0.6f, 0.72f, fractal(uv, 8, seed));
  const float leaf = tiled(uv, 9, seed + 5);
  Texel t;
  t.color = glm::mix(p.base * (0.85f + 0.25f * leaf), p.second, worn);
  t.height = 1.3f * fractal(uv, 20, seed + 6) - worn;
  t.roughness = glm::mix(0.28f + 0.15f * leaf, 0.8f, worn);
  t.metallic = 1 - worn;
  return t;
}

Texel mosaic(glm::vec2 uv, const Palette& p, std::uint32_t seed) {
  constexpr float kTiles = 40;
  const glm::vec2 cell = glm::floor(uv * kTiles);
  const glm::vec2 q = glm::abs(glm::fract(uv * kTiles) - 0.5f);
  Random random(seed, static_cast<std::uint64_t>(cell.y) * 64 + static_cast<std::uint64_t>(cell.x));
  const float wave = 0.5f + 0.5f * std::sin(kTau * (3 * uv.x + 2 * uv.y + fractal(uv, 3, seed)));
  const float tone = random.range(0.75f, 1.2f);
  const float joint = glm::smoothstep(0.4f, 0.47f, std::max(q.x, q.y));
  const glm::vec3 stone = random.chance(0.12f) ? p.third : random.unit() < wave ? p.second : p.base;
  Texel t;
  t.color = glm::mix(stone * tone, glm::vec3(0.35f, 0.33f, 0.3f), joint);
  t.height = -2.5f * joint + random.range(0.0f, 0.6f);
  t.roughness = glm::mix(0.2f * tone, 0.9f, joint);
  return t;
}

struct Finish {
  Texel (*texel)(glm::vec2 uv, const Palette& palette, std::uint32_t seed);
  bool metal_rough;
  bool relief;
  float roughness;
  std::array<Palette, 3> palettes;
};

const std::array<Finish, kFinishKinds>& finishes() {
  static const std::array<Finish, kFinishKinds> kFinishes = {{
      {marble,
       false,
       false,
       0.32f,
       {{{rgb(0xe9e5dc), rgb(0xb9b4ac), rgb(0x6d6a68)},
         {rgb(0x2b2c30), rgb(0x565760), rgb(0xd8d2c6)},
         {rgb(0x4d6b58), rgb(0x2a4034), rgb(0xd0d8cc)}}}},
      {bronze,
       true,
       true,
       1,
       {{{rgb(0xb07a45), rgb(0x5f9a86), {}},
         {rgb(0x8a5a34), rgb(0x3f6f64), {}},
         {rgb(0xc08e5a), rgb(0x4a3a2c), {}}}}},
      {terracotta,
       false,
       true,
       0.85f,
       {{{rgb(0xb8653f), rgb(0x241a17), {}},
         {rgb(0xc98a5c), rgb(0x7a2d1d), {}},
         {rgb(0x9c4a30), rgb(0xe8d8b8), {}}}}},
      {glaze,
       false,
       true,
       0.14f,
       {{{rgb(0xe6ebe8), rgb(0x23488c), rgb(0xd9a441)},
         {rgb(0x1f6f6a), rgb(0xe3d9b8), rgb(0x8c2f22)},
         {rgb(0x7c1f2c), rgb(0xe9c9a2), rgb(0x1e2a4a)}}}},
      {granite,
       false,
       true,
       0.6f,
       {{{rgb(0x8d8a88), rgb(0x3a3a3d), rgb(0xd9d5d0)},
         {rgb(0x9a6458), rgb(0x3b2c2a), rgb(0xd9b8a8)},
         {rgb(0x4a5560), rgb(0x22262c), rgb(0x9fb0bd)}}}},
      {mosaic,
       true,
       true,
       1,
       {{{rgb(0x1f5f8f), rgb(0x3fa7a0), rgb(0xe2b84a)},
         {rgb(0xa33a2a), rgb(0xd98a3a), rgb(0xf0e2c0)},
         {rgb(0x35522f), rgb(0x8fae4a), rgb(0xd8d2c0)}}}},
      {sandstone,
       false,
       true,
       0.92f,
       {{{rgb(0xd3b587), rgb(0xa8794c), {}},
         {rgb(0xc79a7a), rgb(0x8c4f3a), {}},
         {rgb(0xcfc3a6), rgb(0x8f8468), {}}}}},
      {gilding,
       true,
       true,
       1,
       {{{rgb(0xe8b84f), rgb(0x6a2a1c), {}},
         {rgb(0xd9d9dc), rgb(0x3a3c40), {}},
         {rgb(0xe0a080), rgb(0x4a2a24), {}}}}},
      {wood,
       false,
       true,
       0.55f,
       {{{rgb(0x8a5a33), rgb(0x4f2f19), {}},
         {rgb(0xb98a58), rgb(0x7d5530), {}},
         {rgb(0x4a3024), rgb(0x2a1a13), {}}}}},
  }};
  return kFinishes;
}

Image blank(std::uint32_t side, bool srgb) {
  Image image;
  image.width = image.height = side;
  image.srgb = srgb;
  image.rgba.resize(std::size_t{4} * side * side, 255);
  return image;
}

std::uint8_t byte_of(float unit) {
  return static_cast<std::uint8_t>(glm::clamp(unit, 0.0f, 1.0f) * 255 + 0.5f);
}

Image normals_of(const std::vector<float>& heights, std::uint32_t side) {
  Image image = blank(side, false);
  const auto height = [&](std::uint32_t x, std::uint32_t y) {
    return heights[std::size_t{y % side} * side + x % side];
  };
  const float per_texel = 0.5f * static_cast<float>(side) / 512;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const glm::vec3 n =
          glm::normalize(glm::vec3(per_texel * (height(x + side - 1, y) - height(x + 1, y)),
                                   per_texel * (height(x, y + side - 1) - height(x, y + 1)), 1));
      std::uint8_t* const out = &image.rgba[(std::size_t{y} * side + x) * 4];
      for (int c = 0; c < 3; ++c) out[c] = byte_of(0.5f * n[c] + 0.5f);
    }
  }
  return image;
}

}  // namespace

SculptureFinish paint_finish(std::uint32_t kind, std::uint32_t seed, std::uint32_t side,
                             bool with_normals) {
  const Finish& finish = finishes()[kind];
  Random random(seed, 111);
  Palette palette = finish.palettes[random.index(3)];
  for (glm::vec3* color : {&palette.base, &palette.second, &palette.third}) {
    *color *= random.range(0.85f, 1.15f);
  }
  SculptureFinish out;
  out.color = blank(side, true);
  if (finish.metal_rough) out.metal_rough = blank(side, false);
  out.roughness = finish.roughness;
  out.metallic = finish.metal_rough ? 1.0f : 0.0f;
  std::vector<float> heights(std::size_t{side} * side);
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const glm::vec2 uv = (glm::vec2(x, y) + 0.5f) / static_cast<float>(side);
      const Texel t = finish.texel(uv, palette, seed);
      const std::size_t i = std::size_t{y} * side + x;
      heights[i] = t.height;
      for (int c = 0; c < 3; ++c) {
        out.color.rgba[i * 4 + static_cast<std::size_t>(c)] = srgb_byte(t.color[c]);
      }
      if (!finish.metal_rough) continue;
      out.metal_rough.rgba[i * 4 + 1] = byte_of(t.roughness);
      out.metal_rough.rgba[i * 4 + 2] = byte_of(t.metallic);
    }
  }
  if (finish.relief && with_normals) out.normal = normals_of(heights, side);
  return out;
}

}  // namespace mirage::builtin
