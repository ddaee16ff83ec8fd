#pragma once
// Tile source: where finished tiles lie beyond a server's memory, slower than that and faster than
// rendering. Tiles are pure functions of their keys: a source that is lost, slow or full costs
// time, never a picture, so nothing here reports an error to who asks.
// Thread: any; calls take as long as the source does and are the fetch stage's.

#include <optional>

#include "protocol/base/bytes.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {

class TileSource {
 public:
  enum class Tier : std::uint8_t { kDirectory, kRedis };

  virtual ~TileSource() = default;
  virtual Tier tier() const = 0;
  /// For so long an ask waits for it, before the tile is rendered instead.
  virtual std::int64_t patience_us() const = 0;
  /// The record that was offered under this id, unchecked; all forms without loss are one record.
  virtual std::optional<Bytes> fetch(const FormId& id) = 0;
  /// To be kept, in place of what lies there. False: it is not.
  virtual bool offer(const FormId& id, const Bytes& record) = 0;
  /// Before a tile is rendered that no source has. False: another server that shares this source
  /// has said so of the same tile a short while ago and is about to offer it.
  virtual bool claim(const TileId&) { return true; }
};

}  // namespace mirage
