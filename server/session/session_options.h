#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/codec/tile_codec.h"

namespace mirage {

struct SessionOptions {
  std::string token;          ///< empty: no client needs one
  std::string renderer;       ///< told to clients
  std::uint64_t profile = 0;  ///< of what draws and encodes (RenderProfile)
  bool geometry = true;
  bool reference = true;
  bool view = true;  ///< the whole scene as one tile is sent to who asks for it
  bool shadows = false;
  std::size_t max_clients = 4096;
  std::size_t max_outbox_bytes = 512u << 20;  ///< of one client, before it is closed
  /// That clients may ask for, the first that a client takes is its own.
  std::vector<TileCodec> codecs = {TileCodec::kZstd, TileCodec::kRaw, TileCodec::kWebp};
};

}  // namespace mirage
