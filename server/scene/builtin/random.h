#pragma once
// Seeded randomness that gives the same numbers on every platform and standard library.

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace mirage::builtin {

/// SplitMix64 finaliser (Steele et al. 2014): a good hash of any 64 bits.
inline std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// SplitMix64 generator. If the order matters, draw at most one number per full expression: the
/// order of evaluation of function arguments is unspecified (braced lists are ordered).
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) : state_(mix_bits(seed) ^ mix_bits(~stream)) {}

  std::uint64_t bits() { return mix_bits(state_ += 0x9e3779b97f4a7c15ull); }
  /// Returns a number in [0, 1).
  float unit() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
  float range(float low, float high) { return low + (high - low) * unit(); }
  /// Returns an integer in [0, count).
  std::uint32_t index(std::uint32_t count) {
    return static_cast<std::uint32_t>(((bits() >> 32) * count) >> 32);
  }
  bool chance(float probability) { return unit() < probability; }
  float angle() { return range(0, 6.2831853f); }
  /// Returns a uniformly distributed unit vector.
  glm::vec3 direction() {
    const float z = range(-1, 1);
    const float a = angle();
    const float r = std::sqrt(1 - z * z);
    return {r * std::cos(a), z, r * std::sin(a)};
  }

 private:
  std::uint64_t state_;
};

/// Returns value noise in [0, 1] with smooth interpolation; `period` > 0 makes it tile.
float value_noise(glm::vec2 p, std::uint32_t seed, int period = 0);
float value_noise(glm::vec3 p, std::uint32_t seed);
/// Returns four octaves of value noise in [0, 1].
float fractal_noise(glm::vec2 p, std::uint32_t seed, int period = 0);
float fractal_noise(glm::vec3 p, std::uint32_t seed);

}  // namespace mirage::builtin
