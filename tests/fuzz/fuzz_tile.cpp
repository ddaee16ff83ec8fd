// Tile bytes: 12 bytes of header fields, then the planes.
#include <cstddef>
#include <cstdint>

#include "fuzz_targets.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/message.h"

namespace mirage::fuzz {

/// u16 edge, crop x, y, w, h (little-endian), u8 codec, u8 above 0: a relit tile.
void run_tile(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kFieldBytes = 12;
  if (size < kFieldBytes) return;
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint16_t>(data[at] | data[at + 1] << 8);
  };
  wire::TileReplyT reply;
  reply.edge = word(0);
  reply.crop_x = word(2);
  reply.crop_y = word(4);
  reply.crop_w = word(6);
  reply.crop_h = word(8);
  reply.channels = data[11] == 0   ? kLitTile
                   : data[11] == 2 ? kShadowTile
                   : data[11] == 3 ? kCasterTile
                   : data[11] == 4 ? kLayeredTile
                                   : kRelitTile;
  Result<Tile> tile = tile_from_fields(reply);
  if (!tile) return;
  const auto codec = static_cast<TileCodec>(data[10]);
  if (!decode_tile_planes(data + kFieldBytes, size - kFieldBytes, codec, *tile)) return;
  const std::size_t area = tile->crop.area();
  const auto planes = [&](TileChannel channel) { return tile->channels & channel ? area : 0; };
  if (tile->rgba.size() != planes(kChannelColor) * 4 ||
      tile->surface.size() != planes(kChannelNormal) * 4 ||
      tile->depth.size() != planes(kChannelDepth) ||
      tile->behind.size() != planes(kChannelBehind) * 4 ||
      tile->behind_depth.size() != planes(kChannelBehind) ||
      tile->shadow.size() != planes(kChannelShadow)) {
    fail("planes do not have the size of their crop");
  }
  const std::vector<std::uint8_t> bytes = encode_tile_planes(*tile, codec);
  Tile again = *tile;
  const bool ok = decode_tile_planes(bytes.data(), bytes.size(), codec, again).ok();
  // A lossy codec may change colours; everything else must survive.
  if (is_lossy(codec)) again.rgba = tile->rgba;
  if (!ok || tile_content_hash(again) != tile_content_hash(*tile)) {
    fail("a decoded tile does not survive encoding");
  }
}

}  // namespace mirage::fuzz

#ifdef MIRAGE_FUZZ_ENTRY
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mirage::fuzz::run_tile(data, size);
  return 0;
}
#endif
