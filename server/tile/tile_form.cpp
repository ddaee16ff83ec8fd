#include "server/tile/tile_form.h"

#include "protocol/base/clock.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/codec/tile_color.h"
#include "protocol/wire/conversions.h"

namespace mirage {

StoredTilePtr make_form(const Tile& tile, wire::TileReplyT fields, TileCodec codec) {
  const SteadyClock clock;
  auto form = std::make_shared<StoredTile>();
  form->planes = encode_tile_planes(tile, codec);
  form->reply = std::move(fields);
  set_tile_fields(tile, form->reply);
  form->reply.codec = static_cast<std::uint8_t>(codec);
  form->reply.color_rms = 0;
  form->reply.color_max = 0;
  if (is_lossy(codec)) {
    Tile decoded = tile;
    const Bytes& planes = form->planes;
    if (!decode_tile_planes(planes.data(), planes.size(), codec, decoded)) return nullptr;
    const ColorError error = color_error(tile.rgba, decoded.rgba);
    form->reply.color_rms = error.rms;
    form->reply.color_max = error.max;
    form->reply.content_hash = tile_content_hash(decoded);
  } else {
    form->reply.content_hash = tile_content_hash(tile);
  }
  form->reply.encode_us += static_cast<std::uint32_t>(clock.now_us());
  return form;
}

StoredTilePtr smaller_form(StoredTilePtr lossless, StoredTilePtr lossy) {
  return lossy && lossy->planes.size() < lossless->planes.size() ? lossy : lossless;
}

StoredTilePtr convert_form(const StoredTilePtr& lossless, TileCodec codec) {
  Result<Tile> tile = tile_from_fields(lossless->reply);
  if (!tile) return nullptr;
  const auto from = static_cast<TileCodec>(lossless->reply.codec);
  const Bytes& planes = lossless->planes;
  if (!decode_tile_planes(planes.data(), planes.size(), from, *tile)) return nullptr;
  if (!is_lossy(codec)) return make_form(*tile, lossless->reply, codec);
  const StoredTilePtr zstd =
      from == TileCodec::kZstd ? lossless : make_form(*tile, lossless->reply, TileCodec::kZstd);
  return smaller_form(zstd, make_form(*tile, lossless->reply, codec));
}

}  // namespace mirage
