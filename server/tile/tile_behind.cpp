#include "server/tile/tile_behind.h"

#include <algorithm>

#include "protocol/codec/tile_color.h"

namespace mirage {
namespace {

// Share of a tile's visible texels that must hide something. In trees, a third and more do.
constexpr double kWorthShare = 0.1;

}  // namespace

void unpack_behind(const std::vector<std::uint8_t>& packed, Tile& tile) {
  const std::size_t texels = packed.size() / 4;
  tile.behind.assign(packed.size(), 0);
  tile.behind_depth.assign(texels, 0);
  for (std::size_t i = 0; i < texels; ++i) {
    const std::uint8_t* from = &packed[i * 4];
    if (from[3] == 0) continue;
    std::uint8_t* to = &tile.behind[i * 4];
    const int cover = (from[0] % kBehindStep) * 2 + (from[1] % kBehindStep) / 4;
    to[3] = static_cast<std::uint8_t>(cover * 17);
    for (int k = 0; k < 3; ++k) {
      to[k] = static_cast<std::uint8_t>((from[k] / kBehindStep * 255 + 15) / 31);
    }
    tile.behind_depth[i] = from[3];
  }
}

void drop_poor_layer(Tile& tile) {
  const auto covered = [](const std::vector<std::uint8_t>& codes) {
    return static_cast<double>(codes.size()) -
           static_cast<double>(std::count(codes.begin(), codes.end(), 0));
  };
  if (covered(tile.behind_depth) >= kWorthShare * covered(tile.depth)) return;
  tile.rgba = front_over_behind(tile.rgba, tile.behind);
  std::fill(tile.behind.begin(), tile.behind.end(), std::uint8_t{0});
  std::fill(tile.behind_depth.begin(), tile.behind_depth.end(), std::uint8_t{0});
}

}  // namespace mirage
