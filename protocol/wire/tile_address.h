#pragma once
// The address of a tile as one word, for HTTP: GET /v1/tile/REVISION/ADDRESS, with the revision in
// sixteen hexadecimal digits. An address is eight numbers and a codec, separated by dots:
//
//   INSTANCE.LEVEL.X.Y.DISTANCE_LEVEL.DISTANCE.SIZE_CLASS.CHANNELS[.PHASE].CODEC
//
// for example 12.3.5.4.0.0.8.3.zstd. It names a tile of the object that the instance shows, under
// the scene's own lighting. A tile has one address for each instance of its object. If the instance
// makes no difference, the first one that shows the object is used.

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/codec/codec_id.h"
#include "protocol/impostor/view_cell.h"

namespace mirage {

struct TileAddress {
  std::uint32_t instance = 0;
  ViewCell cell;
  DistanceBucket distance;
  std::uint8_t size_class = 0;
  std::uint8_t channels = 0;
  std::uint16_t phase = 0;  ///< omitted from the text when 0
  TileCodec codec = TileCodec::kZstd;

  std::string text() const;
};

/// Parses an address; nullopt if it is invalid or not spelled as text() does, so that no tile has
/// two spellings.
std::optional<TileAddress> parse_tile_address(const std::string& text);

}  // namespace mirage
