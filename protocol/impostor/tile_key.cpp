#include "protocol/impostor/tile_key.h"

#include <xxhash.h>

#include <array>
#include <cmath>

#include "protocol/base/limits.h"

namespace mirage {
namespace {

// Byte by byte, so that the hash does not depend on padding or on the machine's byte order.
class CanonicalBytes {
 public:
  template <typename T>
  void put(T value) {
    auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i, bits >>= 8) {
      bytes_[size_++] = static_cast<std::uint8_t>(bits);
    }
  }
  TileId hash() const {
    const XXH128_hash_t h = XXH3_128bits(bytes_.data(), size_);
    return {h.low64, h.high64};
  }

 private:
  std::array<std::uint8_t, 64> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace

TileId tile_id(const TileKey& key) {
  CanonicalBytes bytes;
  bytes.put(key.scene_revision);
  bytes.put(key.object);
  bytes.put(key.cell.level);
  bytes.put(key.cell.x);
  bytes.put(key.cell.y);
  bytes.put(key.distance.level);
  bytes.put(static_cast<std::uint32_t>(key.distance.index));
  bytes.put(key.size_class);
  bytes.put(key.lighting);
  bytes.put(key.phase);
  bytes.put(key.channels);
  bytes.put(key.instance);
  return bytes.hash();
}

std::uint32_t tile_edge(int size_class) {
  return static_cast<std::uint32_t>(std::lround(16.0 * std::exp2(0.5 * size_class)));
}

int size_class_for(double texels) {
  int c = 0;
  while (c < limits::kMaxSizeClass && tile_edge(c) < texels) ++c;
  return c;
}

}  // namespace mirage
