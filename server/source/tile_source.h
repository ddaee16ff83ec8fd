#pragma once
// Tile source: a place where finished tiles are kept beyond a server's memory. It is slower than
// memory and faster than rendering. Tiles are pure functions of their keys, so a source that is
// lost, slow or full costs time, never a picture. Therefore no call reports an error.
// Thread: any; calls are blocking and belong to the fetch stage.

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
  /// Returns how long an ask waits for this source before the tile is rendered instead, µs.
  virtual std::int64_t patience_us() const = 0;
  /// Returns the record that was offered under this id, unchecked. All lossless forms share one
  /// record.
  virtual std::optional<Bytes> fetch(const FormId& id) = 0;
  /// Stores a record in place of the one there; false if it was not kept.
  virtual bool offer(const FormId& id, const Bytes& record) = 0;
  /// Announces that this server renders a tile that no source has. False: another server that
  /// shares this source announced the same tile a short while ago and is about to offer it.
  virtual bool claim(const TileId&) { return true; }
};

}  // namespace mirage
