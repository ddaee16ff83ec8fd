#include "protocol/light_probe.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace mirage {
namespace {

constexpr int kMantissaBits = 9, kExponentBias = 15;
constexpr float kGreatest = 65408.0f;  // 511 / 512 * 2^16
constexpr std::size_t kTexelBytes = 4 * kProbeTexels;

// Red, green, blue, exponent. On the wire each is the difference from the texel on its left, green
// and blue less red's, small ones of either sign being small numbers: reflections are smooth, and
// many are gray. A plane of the low 8 bits for each colour, one of the three ninth bits above the
// exponent.
using Fields = std::array<std::uint32_t, 4>;

Fields fields(std::uint32_t texel) {
  return {texel & 511u, (texel >> 9) & 511u, (texel >> 18) & 511u, texel >> 27};
}
std::uint32_t folded(std::uint32_t v) { return v < 256 ? 2 * v : 2 * (512 - v) - 1; }
std::uint32_t unfolded(std::uint32_t v) { return v % 2 == 0 ? v / 2 : 512 - (v + 1) / 2; }

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
  // Past an edge the map goes on at the mirrored place of the same edge.
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

Bytes encode_probe(const LightProbe& probe) {
  wire::LightProbePageT page;
  page.id = probe.id;
  for (const glm::vec3& c : probe.irradiance) {
    for (int i = 0; i < 3; ++i) page.irradiance.push_back(c[i]);
  }
  Bytes planes(kTexelBytes);
  Fields left{};
  for (std::size_t i = 0; i < kProbeTexels; ++i) {
    const Fields now = fields(probe.texels[i]);
    std::uint32_t high = (now[3] - left[3]) & 31u;
    std::uint32_t red = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t step = (now[c] - left[c]) & 511u;
      const std::uint32_t even = folded((step - red) & 511u);
      if (c == 0) red = step;
      planes[c * kProbeTexels + i] = static_cast<std::uint8_t>(even);
      high |= (even >> 8) << (5 + c);
    }
    planes[3 * kProbeTexels + i] = static_cast<std::uint8_t>(high);
    left = now;
  }
  return encode_message(std::move(page), compress_block(planes.data(), planes.size()));
}

Result<LightProbe> decode_probe(const wire::LightProbePageT& page, const Bytes& payload) {
  if (page.irradiance.size() != 3 * kProbeTerms) {
    return make_error(ErrorId::kWireValue, "light probe without its irradiance");
  }
  Result<Bytes> planes = decompress_block(payload.data(), payload.size(), kTexelBytes);
  if (!planes) return planes.error();
  LightProbe out;
  for (std::size_t i = 0; i < 3 * kProbeTerms; ++i) {
    out.irradiance[i / 3][static_cast<int>(i % 3)] = page.irradiance[i];
  }
  out.texels.reserve(kProbeTexels);
  Fields now{};
  for (std::size_t i = 0; i < kProbeTexels; ++i) {
    const std::uint32_t high = (*planes)[3 * kProbeTexels + i];
    now[3] = (now[3] + high) & 31u;
    std::uint32_t red = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t even = (*planes)[c * kProbeTexels + i] | ((high >> (5 + c)) & 1u) << 8;
      const std::uint32_t step = (unfolded(even) + red) & 511u;
      if (c == 0) red = step;
      now[c] = (now[c] + step) & 511u;
    }
    out.texels.push_back(now[0] | now[1] << 9 | now[2] << 18 | now[3] << 27);
  }
  out.id = probe_id(out);
  if (out.id != page.id) return make_error(ErrorId::kWireValue, "light probe is not its id's");
  return out;
}

}  // namespace mirage
