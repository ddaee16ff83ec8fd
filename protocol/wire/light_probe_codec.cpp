#include "protocol/wire/light_probe_codec.h"

#include "protocol/codec/tile_codec.h"

namespace mirage {
namespace {

constexpr std::size_t kTexelBytes = 4 * kProbeTexels;

// Fields of a texel: red, green, blue, exponent. On the wire each is the difference from the texel
// on its left, and green and blue are then taken relative to red, because reflections are smooth
// and often gray. Small differences of either sign become small numbers. Each colour has a plane of
// its low 8 bits; the three ninth bits share a plane with the exponent.
using Fields = std::array<std::uint32_t, 4>;

Fields fields(std::uint32_t texel) {
  return {texel & 511u, (texel >> 9) & 511u, (texel >> 18) & 511u, texel >> 27};
}
std::uint32_t folded(std::uint32_t v) { return v < 256 ? 2 * v : 2 * (512 - v) - 1; }
std::uint32_t unfolded(std::uint32_t v) { return v % 2 == 0 ? v / 2 : 512 - (v + 1) / 2; }

}  // namespace

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
