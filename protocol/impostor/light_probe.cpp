#include "protocol/impostor/light_probe.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace mirage {
namespace {

constexpr int kMantissaBits = 9, kExponentBias = 15;
constexpr float kGreatest = 65408.0f;  // 511 / 512 * 2^16

}  // namespace

double probe_roughness(std::size_t level) {
  return std::pow(10.0, static_cast<double>(level) / 5.0 - 1.0);
}

glm::vec3 irradiance_over_pi(const LightProbe& probe, const glm::vec3& n) {
  const auto& c = probe.irradiance;
  const glm::vec3 sum = c[0] + c[1] * n.y + c[2] * n.z + c[3] * n.x + c[4] * (n.x * n.y) +
                        c[5] * (n.y * n.z) + c[6] * (3.0f * n.z * n.z - 1.0f) + c[7] * (n.x * n.z) +
                        c[8] * (n.x * n.x - n.y * n.y);
  return glm::max(sum, glm::vec3(0));
}

glm::dvec3 probe_direction(double u, double v) {
  // Beyond an edge, the map continues at the mirrored place of the same edge.
  if (u < 0 || u > 1) {
    u = u < 0 ? -u : 2 - u;
    v = 1 - v;
  }
  if (v < 0 || v > 1) {
    v = v < 0 ? -v : 2 - v;
    u = 1 - u;
  }
  glm::dvec2 p(2 * u - 1, 2 * v - 1);
  const double y = 1 - std::abs(p.x) - std::abs(p.y);
  if (y < 0) {
    p = {(1 - std::abs(p.y)) * (p.x < 0 ? -1 : 1), (1 - std::abs(p.x)) * (p.y < 0 ? -1 : 1)};
  }
  return glm::normalize(glm::dvec3(p.x, y, p.y));
}

std::uint32_t pack_shared_exponent(const glm::vec3& radiance) {
  const glm::vec3 c = glm::clamp(radiance, glm::vec3(0), glm::vec3(kGreatest));
  const float most = std::max({c.r, c.g, c.b, 1e-8f});
  int exponent = std::max(-kExponentBias - 1, static_cast<int>(std::floor(std::log2(most)))) + 1 +
                 kExponentBias;
  const auto step = [&] { return std::ldexp(1.0f, exponent - kExponentBias - kMantissaBits); };
  if (std::floor(most / step() + 0.5f) >= 512.0f) ++exponent;
  std::uint32_t texel = static_cast<std::uint32_t>(exponent) << 27;
  for (int i = 0; i < 3; ++i) {
    const auto value = static_cast<std::uint32_t>(std::floor(c[i] / step() + 0.5f));
    texel |= std::min(value, 511u) << (kMantissaBits * i);
  }
  return texel;
}

glm::vec3 unpack_shared_exponent(std::uint32_t texel) {
  const float step =
      std::ldexp(1.0f, static_cast<int>(texel >> 27) - kExponentBias - kMantissaBits);
  return glm::vec3(texel & 511u, (texel >> 9) & 511u, (texel >> 18) & 511u) * step;
}

std::uint64_t probe_id(const LightProbe& probe) {
  const std::uint64_t light = XXH3_64bits(probe.irradiance.data(), sizeof(probe.irradiance));
  const std::uint64_t both =
      XXH3_64bits_withSeed(probe.texels.data(), probe.texels.size() * sizeof(std::uint32_t), light);
  return std::max<std::uint64_t>(both, 1);
}

}  // namespace mirage
