#pragma once
// What a tile will weigh when it comes, learnt from those that came: small tiles take more bytes
// per texel than large ones, shadows fewer than pictures.
// Input:  tiles asked for, tiles received. Output: bytes to expect.
// Thread: the frame loop's. Never full: one mean for each size of each kind.

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace mirage {

class TileBytes {
 public:
  /// Bytes on the wire of a tile of this size class and these channels (tile_key.h).
  double expected(std::uint8_t size_class, std::uint8_t channels) const;
  void arrived(std::uint8_t size_class, std::uint8_t channels, std::size_t bytes);

 private:
  struct Mean {
    double bytes = 0;
    int count = 0;  ///< tiles it stands for
  };
  /// Bytes per texel of a lit tile, from the size nearest to this one; of its own kind if any came.
  double lit_per_texel(std::uint8_t size_class, std::uint8_t channels) const;

  std::map<std::pair<std::uint8_t, std::uint8_t>, Mean> means_;  ///< by channels, size class
};

}  // namespace mirage
