#pragma once
// Tile identity. A tile is a pure function of its key: equal key, equal bytes.

#include <cstdint>
#include <functional>
#include <vector>

#include "protocol/impostor/view_cell.h"

namespace mirage {

/// Bits that name the channels of a tile.
enum TileChannel : std::uint8_t {
  kChannelColor = 1,
  kChannelDepth = 2,
  kChannelNormal = 4,
  kChannelMaterial = 8,
  kChannelShadow = 16,
  kChannelBehind = 32,
};

/// The two kinds of picture: shaded by the server for one lighting, or by the client for any
/// lighting.
inline constexpr std::uint8_t kLitTile = kChannelColor | kChannelDepth;
inline constexpr std::uint8_t kRelitTile = kLitTile | kChannelNormal | kChannelMaterial;
/// A lit tile in two layers: its front, and the surface hidden behind it. For objects that are
/// layered().
inline constexpr std::uint8_t kLayeredTile = kLitTile | kChannelBehind;
/// The light that the sun's shadows leave on one instance under one lighting (TECHNIQUES row 7).
inline constexpr std::uint8_t kShadowTile = kChannelShadow;
/// The shape of an object alone, for drawing into a shadow map.
inline constexpr std::uint8_t kCasterTile = kChannelDepth;
inline bool is_lit(std::uint8_t c) { return c == kLitTile || c == kLayeredTile; }
inline bool is_picture(std::uint8_t c) { return is_lit(c) || c == kRelitTile; }
inline bool valid_channels(std::uint8_t c) {
  return is_picture(c) || c == kShadowTile || c == kCasterTile;
}

struct TileKey {
  std::uint64_t scene_revision = 0;
  std::uint32_t object = 0;
  ViewCell cell;
  DistanceBucket distance;
  std::uint8_t size_class = 0;
  /// ObjectLighting::hash(); for a shadow tile lighting_hash(); 0: an unlit object, a relit or a
  /// caster tile.
  std::uint64_t lighting = 0;
  std::uint32_t phase = 0;  ///< Phase (motion.h); 0 when static
  std::uint8_t channels = kLitTile;
  std::uint32_t instance = 0;  ///< for a shadow tile: the instance, counted from 1; else 0
};

/// 128-bit hash of the key's canonical bytes (xxHash, little-endian).
struct TileId {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
  friend bool operator==(const TileId& a, const TileId& b) {
    return a.low == b.low && a.high == b.high;
  }
  friend bool operator<(const TileId& a, const TileId& b) {
    return a.high != b.high ? a.high < b.high : a.low < b.low;
  }
};
TileId tile_id(const TileKey& key);
/// Returns the key byte by byte, independent of padding and of the machine's byte order.
std::vector<std::uint8_t> canonical_bytes(const TileKey& key);

/// Returns the tile edge in texels, in steps of sqrt 2 from 16 (class 0) to 2048 (class 14).
std::uint32_t tile_edge(int size_class);
/// Returns the smallest class with an edge of at least `texels`; the largest class if none has.
int size_class_for(double texels);

}  // namespace mirage

template <>
struct std::hash<mirage::TileId> {
  std::size_t operator()(const mirage::TileId& id) const noexcept {
    return static_cast<std::size_t>(id.low ^ id.high);
  }
};
