#pragma once
// Tile bytes: expects how many bytes a tile will take, learnt from tiles that arrived. Small tiles
// take more bytes a texel than large ones, shadows fewer than pictures.
// Input:  tiles asked for, tiles received.
// Output: bytes to expect.
// Thread: the frame loop's.
// Full:   never; one mean for each size of each kind.

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace mirage {

class TileBytes {
 public:
  /// Returns the expected bytes on the wire of a tile of this size class and these channels
  /// (tile_key.h).
  double expected(std::uint8_t size_class, std::uint8_t channels) const;
  void arrived(std::uint8_t size_class, std::uint8_t channels, std::size_t bytes);

 private:
  struct Mean {
    double bytes = 0;
    int count = 0;  ///< number of tiles
  };
  /// Returns bytes a texel of a lit tile, from tiles of the nearest size, of the same kind if there
  /// are any.
  double lit_per_texel(std::uint8_t size_class, std::uint8_t channels) const;

  std::map<std::pair<std::uint8_t, std::uint8_t>, Mean> means_;  ///< by channels and size class
};

}  // namespace mirage
