#include "protocol/codec/vertex_codec.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mirage {
namespace {

constexpr float kSteps10 = 1023.0f;

std::uint16_t quantise(float v, float low, float size) {
  if (!(size > 0)) return 0;
  return static_cast<std::uint16_t>(
      std::lround(std::clamp((v - low) / size, 0.0f, 1.0f) * kVertexSteps));
}
float dequantise(std::uint16_t v, float low, float size) {
  return low + size * (static_cast<float>(v) / kVertexSteps);
}

// Octahedral map of the unit sphere (Cigolle et al., "A survey of efficient representations for
// independent unit vectors", 2014).
glm::vec2 octahedral(const glm::vec3& v) {
  const float sum = std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
  if (!(sum > 0)) return glm::vec2(0);
  const glm::vec2 p = glm::vec2(v) / sum;
  if (v.z >= 0) return p;
  return {(1 - std::abs(p.y)) * (p.x >= 0 ? 1.0f : -1.0f),
          (1 - std::abs(p.x)) * (p.y >= 0 ? 1.0f : -1.0f)};
}
glm::vec3 from_octahedral(const glm::vec2& e) {
  glm::vec3 v(e, 1 - std::abs(e.x) - std::abs(e.y));
  if (v.z < 0) {
    v.x = (1 - std::abs(e.y)) * (e.x >= 0 ? 1.0f : -1.0f);
    v.y = (1 - std::abs(e.x)) * (e.y >= 0 ? 1.0f : -1.0f);
  }
  return glm::normalize(v);
}

// Tries the four codes around the exact place, because plain rounding can be twice as far off.
std::array<std::uint16_t, 2> encode_direction(const glm::vec3& v) {
  const glm::vec2 exact = (octahedral(v) * 0.5f + 0.5f) * kSteps10;
  std::array<std::uint16_t, 2> best{};
  float least = 9;
  for (int k = 0; k < 4; ++k) {
    const glm::vec2 code =
        glm::clamp(glm::floor(exact) + glm::vec2(k & 1, k >> 1), glm::vec2(0), glm::vec2(kSteps10));
    // The difference vector is compared: near 1, a float's cosine cannot resolve a thousandth of a
    // radian.
    const glm::vec3 off = from_octahedral(code / kSteps10 * 2.0f - 1.0f) - v;
    const float off2 = glm::dot(off, off);
    if (off2 >= least) continue;
    least = off2;
    best = {static_cast<std::uint16_t>(code.x), static_cast<std::uint16_t>(code.y)};
  }
  return best;
}
glm::vec3 decode_direction(std::uint16_t x, std::uint16_t y) {
  const glm::vec2 code(std::min(static_cast<float>(x), kSteps10),
                       std::min(static_cast<float>(y), kSteps10));
  return from_octahedral(code / kSteps10 * 2.0f - 1.0f);
}

}  // namespace

void put_vertex(ByteWriter& w, const Vertex& v, const VertexLayout& layout) {
  for (int c = 0; c < 3; ++c) {
    w.put(quantise(v.position[c], layout.position.low[c], layout.position.size[c]));
  }
  for (const std::uint16_t part : encode_direction(v.normal)) w.put(part);
  w.put(std::uint16_t{0});  // meshoptimizer needs a vertex size that is a multiple of 4 bytes
  if (layout.streams & kTangent) {
    const auto t = encode_direction(glm::vec3(v.tangent));
    w.put(t[0]);
    w.put(static_cast<std::uint16_t>(t[1] * 2 + (v.tangent.w < 0 ? 1 : 0)));
  }
  const auto put_uv = [&](const glm::vec2& uv, const Range<glm::vec2>& range) {
    for (int c = 0; c < 2; ++c) w.put(quantise(uv[c], range.low[c], range.size[c]));
  };
  if (layout.streams & kUv0) put_uv(v.uv0, layout.uv0);
  if (layout.streams & kUv1) put_uv(v.uv1, layout.uv1);
  if (layout.streams & kColor) {
    for (int c = 0; c < 4; ++c) {
      const float linear = static_cast<float>(v.color[c]) / kVertexSteps;
      w.put(static_cast<std::uint8_t>(std::lround((c < 3 ? std::sqrt(linear) : linear) * 255.0f)));
    }
  }
}

Vertex get_vertex(ByteReader& r, const VertexLayout& layout) {
  Vertex v;
  for (int c = 0; c < 3; ++c) {
    v.position[c] =
        dequantise(r.get<std::uint16_t>(), layout.position.low[c], layout.position.size[c]);
  }
  const auto x = r.get<std::uint16_t>(), y = r.get<std::uint16_t>();
  v.normal = decode_direction(x, y);
  r.get<std::uint16_t>();
  if (layout.streams & kTangent) {
    const auto tx = r.get<std::uint16_t>(), ty = r.get<std::uint16_t>();
    v.tangent = glm::vec4(decode_direction(tx, ty / 2), ty % 2 ? -1.0f : 1.0f);
  }
  const auto get_uv = [&](const Range<glm::vec2>& range) {
    glm::vec2 uv;
    for (int c = 0; c < 2; ++c) {
      uv[c] = dequantise(r.get<std::uint16_t>(), range.low[c], range.size[c]);
    }
    return uv;
  };
  if (layout.streams & kUv0) v.uv0 = get_uv(layout.uv0);
  if (layout.streams & kUv1) v.uv1 = get_uv(layout.uv1);
  if (layout.streams & kColor) {
    for (int c = 0; c < 4; ++c) {
      const float code = static_cast<float>(r.get<std::uint8_t>()) / 255.0f;
      v.color[c] =
          static_cast<std::uint16_t>(std::lround((c < 3 ? code * code : code) * kVertexSteps));
    }
  }
  return v;
}

}  // namespace mirage
