#include "client/price/tile_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "protocol/impostor/tile.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

constexpr double kReplyBytes = 160;  // bytes of a reply beside its texels
// Bytes a texel of lit tiles of 128 texels, before any has arrived. Smaller tiles take more a
// texel, by about the root of the edge. Measured with a quicker compressor on forest, clutter and
// city: 2.4, 2.7, 2.2 at 16 texels; .9, .9, .5 at 128; .9, .4, .4 at 256. zstd makes them a fifth
// smaller.
constexpr double kBytesPerTexel = 0.6;
constexpr double kUsualEdge = 128;
constexpr int kFirstGuess = 3;  // the guess counts as this many tiles
constexpr int kMemory = 20;     // tiles that the running mean covers

// Bytes relative to those of a lit tile: measured 1.1 (knot) to 2.0 (flight helmet).
double share_of_lit(std::uint8_t channels) {
  if (!is_picture(channels)) return 0.3;
  return channels == kLitTile ? 1.0 : 1.6;
}

double texels(std::uint8_t size_class) {
  const double edge = tile_edge(size_class);
  return edge * edge;
}

// Bytes a texel relative to those of a tile of the usual edge.
double share_of_usual(std::uint8_t size_class) {
  return std::sqrt(kUsualEdge / tile_edge(size_class));
}

}  // namespace

double TileBytes::lit_per_texel(std::uint8_t size_class, std::uint8_t channels) const {
  double per_texel = kBytesPerTexel;
  std::pair<bool, int> nearest{true, INT32_MAX};  // another kind?, and size classes apart
  for (const auto& [kind, mean] : means_) {
    const std::pair<bool, int> apart{kind.first != channels, std::abs(kind.second - size_class)};
    if (apart >= nearest) continue;
    nearest = apart;
    per_texel =
        mean.bytes / texels(kind.second) / share_of_lit(kind.first) / share_of_usual(kind.second);
  }
  return per_texel * share_of_usual(size_class);
}

double TileBytes::expected(std::uint8_t size_class, std::uint8_t channels) const {
  const auto known = means_.find({channels, size_class});
  if (known != means_.end()) return known->second.bytes;
  return kReplyBytes +
         lit_per_texel(size_class, channels) * share_of_lit(channels) * texels(size_class);
}

void TileBytes::arrived(std::uint8_t size_class, std::uint8_t channels, std::size_t bytes) {
  Mean& mean =
      means_.try_emplace({channels, size_class}, Mean{expected(size_class, channels), kFirstGuess})
          .first->second;
  mean.count = std::min(mean.count + 1, kMemory);
  mean.bytes += (static_cast<double>(bytes) - mean.bytes) / mean.count;
}

}  // namespace mirage
