#include "server/scene/builtin/random.h"

namespace mirage::builtin {
namespace {

float lattice(int x, int y, int z, std::uint32_t seed) {
  const auto ux = static_cast<std::uint32_t>(x);
  const auto uy = static_cast<std::uint32_t>(y);
  const auto uz = static_cast<std::uint32_t>(z);
  std::uint32_t h = ux * 0x8da6b343u ^ uy * 0xd8163841u ^ uz * 0xcb1ab31fu ^ seed * 0x9e3779b9u;
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  h ^= h >> 16;
  return static_cast<float>(h >> 8) * 0x1p-24f;
}

int wrapped(int v, int period) { return period > 0 ? ((v % period) + period) % period : v; }

}  // namespace

float value_noise(glm::vec2 p, std::uint32_t seed, int period) {
  const glm::vec2 cell = glm::floor(p);
  glm::vec2 f = p - cell;
  f = f * f * (3.0f - 2.0f * f);
  const int x0 = wrapped(static_cast<int>(cell.x), period);
  const int y0 = wrapped(static_cast<int>(cell.y), period);
  const int x1 = wrapped(x0 + 1, period);
  const int y1 = wrapped(y0 + 1, period);
  const float low = glm::mix(lattice(x0, y0, 0, seed), lattice(x1, y0, 0, seed), f.x);
  const float high = glm::mix(lattice(x0, y1, 0, seed), lattice(x1, y1, 0, seed), f.x);
  return glm::mix(low, high, f.y);
}

float value_noise(glm::vec3 p, std::uint32_t seed) {
  const glm::vec3 cell = glm::floor(p);
  glm::vec3 f = p - cell;
  f = f * f * (3.0f - 2.0f * f);
  const glm::ivec3 c(cell);
  float layer[2];
  for (int k = 0; k < 2; ++k) {
    const int z = c.z + k;
    const float low = glm::mix(lattice(c.x, c.y, z, seed), lattice(c.x + 1, c.y, z, seed), f.x);
    const float high =
        glm::mix(lattice(c.x, c.y + 1, z, seed), lattice(c.x + 1, c.y + 1, z, seed), f.x);
    layer[k] = glm::mix(low, high, f.y);
  }
  return glm::mix(layer[0], layer[1], f.z);
}

float fractal_noise(glm::vec2 p, std::uint32_t seed, int period) {
  float sum = 0;
  float amplitude = 0.5f;
  for (std::uint32_t octave = 0; octave < 4; ++octave) {
    sum += amplitude * value_noise(p, seed + octave, period);
    p *= 2.0f;
    period *= 2;
    amplitude *= 0.5f;
  }
  return sum / 0.9375f;
}

float fractal_noise(glm::vec3 p, std::uint32_t seed) {
  float sum = 0;
  float amplitude = 0.5f;
  for (std::uint32_t octave = 0; octave < 4; ++octave) {
    sum += amplitude * value_noise(p, seed + octave);
    p *= 2.0f;
    amplitude *= 0.5f;
  }
  return sum / 0.9375f;
}

}  // namespace mirage::builtin
