#pragma once
// Vertices on the wire: positions and texture coordinates in 16 bits over their range, normals and
// tangents octahedral, colours as square roots in 8 bits.

#include <cstdint>

#include "protocol/base/byte_stream.h"
#include "protocol/model/model.h"

namespace mirage {

// Bits of the streams beyond position and normal.
enum StreamBit : std::uint32_t { kTangent = 1, kUv0 = 2, kUv1 = 4, kColor = 8, kAllStreams = 15 };

/// Number of steps of a 16-bit value over its range.
constexpr float kVertexSteps = 65535.0f;

/// Range that 16-bit values span.
template <typename V>
struct Range {
  V low{0};
  V size{0};

  void grow(const V& v, bool first) {
    const V high = first ? v : glm::max(low + size, v);
    low = first ? v : glm::min(low, v);
    size = high - low;
  }
};

struct VertexLayout {
  std::uint32_t streams = 0;
  Range<glm::vec3> position;
  Range<glm::vec2> uv0, uv1;

  std::size_t stride() const {
    return 12 + (streams & kTangent ? 4u : 0u) + (streams & kUv0 ? 4u : 0u) +
           (streams & kUv1 ? 4u : 0u) + (streams & kColor ? 4u : 0u);
  }
};

/// Appends `layout.stride()` bytes.
void put_vertex(ByteWriter& w, const Vertex& v, const VertexLayout& layout);
/// Reads `layout.stride()` bytes; missing ones read as zeros (see ByteReader).
Vertex get_vertex(ByteReader& r, const VertexLayout& layout);

}  // namespace mirage
