#pragma once
// A tile as one word, by which it is got with HTTP: GET /v1/tile/REVISION/ADDRESS, the revision in
// sixteen hexadecimal digits. Eight numbers and a codec, by dots:
//
//   INSTANCE.LEVEL.X.Y.DISTANCE_LEVEL.DISTANCE.SIZE_CLASS.CHANNELS[.PHASE].CODEC
//
// for example 12.3.5.4.0.0.8.3.zstd. It is of the object that the instance shows, under the scene's
// own lighting. One tile has one address but for its instance: where that makes no difference, it
// is the first that shows the object.

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/view_cell.h"

namespace mirage {

struct TileAddress {
  std::uint32_t instance = 0;
  ViewCell cell;
  DistanceBucket distance;
  std::uint8_t size_class = 0;
  std::uint8_t channels = 0;
  std::uint16_t phase = 0;  ///< left out when 0
  TileCodec codec = TileCodec::kZstd;

  std::string text() const;
};

/// nullopt: it is none, or not spelled as text() does, so that there are no two for one.
std::optional<TileAddress> parse_tile_address(const std::string& text);

}  // namespace mirage
