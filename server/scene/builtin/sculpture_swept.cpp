// Sculptures swept along a curve: knots, rings, ribbons, shells.

#include <algorithm>
#include <array>
#include <cmath>

#include "server/scene/builtin/random.h"
#include "server/scene/builtin/sculpture_forms.h"
#include "server/scene/builtin/tau.h"

namespace mirage::builtin {
namespace {

constexpr float kStep = 1e-3f;  // step along the curve for its direction

/// Returns a point of a superellipse: a circle at sharpness 1, a rounded box below.
glm::vec2 superellipse(float angle, float sharpness) {
  const auto power = [&](float x) { return std::copysign(std::pow(std::abs(x), sharpness), x); };
  return {power(std::cos(angle)), power(std::sin(angle))};
}

/// Sweeps `section` (across, outward) along `curve`; `outward` need only be roughly across it.
template <typename Curve, typename Outward>
glm::vec3 swept(const Curve& curve, const Outward& outward, float t, glm::vec2 section) {
  const glm::vec3 p = curve(t);
  const glm::vec3 along = glm::normalize(curve(t + kStep) - curve(t - kStep));
  glm::vec3 out = outward(t);
  out = glm::normalize(out - along * glm::dot(out, along));
  return p + glm::cross(along, out) * section.x + out * section.y;
}

glm::vec2 turned(glm::vec2 p, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

}  // namespace

SculptureShape shape_knot(std::uint32_t seed) {
  Random random(seed, 91);
  constexpr std::array<glm::ivec2, 6> kWindings = {
      {{2, 3}, {3, 2}, {2, 5}, {3, 4}, {3, 5}, {4, 3}}};
  const glm::vec2 winding(kWindings[random.index(6)]);
  const float fat = random.range(0.2f, 0.34f) * 2.5f / (winding.x + 0.5f);
  const float flat = random.range(0.5f, 1.0f);
  const float sharpness = random.range(0.35f, 1.0f);
  const float twists = static_cast<float>(random.index(9));
  const float ripples = static_cast<float>(20 + random.index(60));
  const float ripple = random.chance(0.6f) ? random.range(0.02f, 0.07f) : 0.0f;
  const auto torus = [=](float t) {
    return glm::vec3(std::cos(winding.x * t), std::sin(winding.x * t), 0.0f);
  };
  const auto curve = [=](float t) {
    const float reach = 1 + 0.42f * std::cos(winding.y * t);
    return torus(t) * reach + glm::vec3(0, 0, 0.55f * std::sin(winding.y * t));
  };
  const auto outward = [=](float t) {
    return torus(t) * std::cos(winding.y * t) + glm::vec3(0, 0, std::sin(winding.y * t));
  };
  GridSurface s;
  s.closes_along_v = true;
  s.aspect = 0.12f;
  s.texture_repeats = {1, 8};
  s.at = [=](float u, float v) {
    const float t = v * kTau;
    glm::vec2 section = superellipse(u * kTau, sharpness) * glm::vec2(fat, fat * flat);
    section *= 1 + ripple * std::sin(ripples * t + 2 * u * kTau);
    const glm::vec3 p = swept(curve, outward, t, turned(section, twists * t));
    return p + 0.012f * (fractal_noise(p * 7.0f, seed) - 0.5f);
  };
  return s;
}

SculptureShape shape_ribbon(std::uint32_t seed) {
  Random random(seed, 92);
  const float twists = static_cast<float>(1 + random.index(4));
  const float waves = static_cast<float>(2 + random.index(3));
  const float wave = random.range(0.1f, 0.3f);
  const float wide = random.range(0.3f, 0.5f);
  const float thick = random.range(0.035f, 0.08f);
  const float lines = static_cast<float>(4 + 2 * random.index(5));
  const auto curve = [=](float t) {
    const float r = 1 + wave * std::cos(waves * t);
    return glm::vec3(r * std::cos(t), r * std::sin(t), 0.35f * std::sin((waves - 1) * t));
  };
  const auto outward = [](float t) { return glm::vec3(std::cos(t), std::sin(t), 0.0f); };
  GridSurface s;
  s.closes_along_v = true;
  s.aspect = 0.3f;
  s.texture_repeats = {2, 6};
  s.at = [=](float u, float v) {
    const float t = v * kTau;
    glm::vec2 section = superellipse(u * kTau, 0.6f) * glm::vec2(wide, thick);
    // Lines carved along the ribbon's faces.
    section.y *= 1 - 0.35f * std::pow(std::abs(std::cos(lines * u * kTau)), 6.0f);
    const glm::vec3 p = swept(curve, outward, t, turned(section, twists * t));
    return p + 0.01f * (fractal_noise(p * 9.0f, seed) - 0.5f);
  };
  return s;
}

SculptureShape shape_ring(std::uint32_t seed) {
  Random random(seed, 93);
  std::array<glm::vec3, 4> swing;
  for (glm::vec3& w : swing) {
    w = {random.range(-0.14f, 0.14f), random.range(-0.14f, 0.14f), random.range(-0.3f, 0.3f)};
  }
  const float fat = random.range(0.14f, 0.24f);
  const float uneven = random.range(0.15f, 0.45f);
  const float beads = static_cast<float>(8 + random.index(30));
  const float bead = random.chance(0.5f) ? random.range(0.1f, 0.3f) : 0.0f;
  const float phase = random.angle();
  const auto curve = [=](float t) {
    glm::vec3 p(std::cos(t), std::sin(t), 0);
    for (std::size_t k = 0; k < swing.size(); ++k) {
      p += swing[k] * std::sin(static_cast<float>(k + 2) * t + phase * static_cast<float>(k));
    }
    return p;
  };
  const auto outward = [](float t) { return glm::vec3(std::cos(t), std::sin(t), 0.0f); };
  GridSurface s;
  s.closes_along_v = true;
  s.aspect = 0.2f;
  s.texture_repeats = {1, 5};
  s.at = [=](float u, float v) {
    const float t = v * kTau;
    float r = fat * (1 + uneven * std::sin(2 * t + phase));
    r *= 1 + bead * (std::abs(std::sin(0.5f * beads * t)) - 0.5f);
    const glm::vec3 p = swept(curve, outward, t, superellipse(u * kTau, 1) * r);
    const glm::vec3 rough(fractal_noise(p * 4.0f, seed), fractal_noise(p * 4.0f, seed + 20),
                          fractal_noise(p * 4.0f, seed + 40));
    return p + 0.08f * (rough - 0.5f);
  };
  return s;
}

SculptureShape shape_shell(std::uint32_t seed) {
  Random random(seed, 94);
  const float turns = random.range(2.2f, 3.4f);
  const float growth = random.range(0.16f, 0.24f);
  const float fat = random.range(0.42f, 0.6f);
  const float spire = random.range(0.0f, 0.9f);
  const float ribs = static_cast<float>(16 + random.index(40));
  const float rib = random.range(0.02f, 0.08f);
  const auto spiral = [=](float a) {
    const float r = std::exp(growth * (a - turns * kTau));
    return glm::vec3(r * std::cos(a), r * std::sin(a), -spire * r);
  };
  const auto outward = [](float a) { return glm::vec3(std::cos(a), std::sin(a), 0.0f); };
  GridSurface s;
  s.aspect = 0.35f;
  s.texture_repeats = {1, 5};
  s.at = [=](float u, float v) {
    // The mouth is closed by a disc.
    const float mouth = 0.985f;
    const float a = std::min(v / mouth, 1.0f) * turns * kTau;
    const float closing = v > mouth ? (1 - v) / (1 - mouth) : std::min(1.0f, v * 60);
    float r = fat * std::exp(growth * (a - turns * kTau)) * closing;
    r *= 1 + rib * std::sin(ribs * a / turns + 1.2f * std::sin(u * kTau));
    r *= 1 + 0.05f * fractal_noise(glm::vec3(3 * std::cos(u * kTau), 3 * std::sin(u * kTau), 4 * a),
                                   seed);
    return swept(spiral, outward, a, superellipse(u * kTau, 1) * std::max(r, 0.0f));
  };
  return s;
}

}  // namespace mirage::builtin
