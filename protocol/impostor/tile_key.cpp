#include "protocol/impostor/tile_key.h"

#include <xxhash.h>

#include <cmath>

#include "protocol/base/limits.h"

namespace mirage {
namespace {

template <typename T>
void put(std::vector<std::uint8_t>& bytes, T value) {
  auto bits = static_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i, bits >>= 8) {
    bytes.push_back(static_cast<std::uint8_t>(bits));
  }
}

}  // namespace

std::vector<std::uint8_t> canonical_bytes(const TileKey& key) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(64);
  put(bytes, key.scene_revision);
  put(bytes, key.object);
  put(bytes, key.cell.level);
  put(bytes, key.cell.x);
  put(bytes, key.cell.y);
  put(bytes, key.distance.level);
  put(bytes, static_cast<std::uint32_t>(key.distance.index));
  put(bytes, key.size_class);
  put(bytes, key.lighting);
  put(bytes, key.phase);
  put(bytes, key.channels);
  put(bytes, key.instance);
  return bytes;
}

TileId tile_id(const TileKey& key) {
  const std::vector<std::uint8_t> bytes = canonical_bytes(key);
  const XXH128_hash_t h = XXH3_128bits(bytes.data(), bytes.size());
  return {h.low64, h.high64};
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
