#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/codec/tile_codec.h"
#include "server/session/access.h"

namespace mirage {

struct SessionOptions {
  Access access;              ///< who may be a client
  std::string renderer;       ///< told to clients
  std::uint64_t profile = 0;  ///< of what draws and encodes (RenderProfile)
  bool geometry = true;
  bool reference = true;
  bool view = true;  ///< the whole scene as one tile is sent to who asks for it
  bool shadows = false;
  std::size_t max_clients = 4096;            ///< with a right hello
  std::size_t max_outbox_bytes = 16u << 20;  ///< that wait for a client: beyond, it is refused more
  /// That clients may ask for, the first that a client takes is its own.
  std::vector<TileCodec> codecs = {TileCodec::kZstd, TileCodec::kRaw, TileCodec::kWebp};
};

}  // namespace mirage
