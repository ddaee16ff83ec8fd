#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/codec/codec_id.h"
#include "server/session/access.h"

namespace mirage {

struct SessionOptions {
  Access access;              ///< rights of clients
  std::string renderer;       ///< told to clients
  std::uint64_t profile = 0;  ///< hash of the renderer and encoders (RenderProfile)
  bool geometry = true;
  bool reference = true;
  bool pictures = true;  ///< full renders as image files, without depth
  bool view = true;      ///< clients may ask for views: the whole scene as one tile
  bool shadows = false;
  bool choices = false;            ///< clients may ask for other clips and variants of the scene
  std::size_t max_clients = 4096;  ///< sessions with a valid hello
  /// unread bytes of a client above which its asks are refused
  std::size_t max_outbox_bytes = 16u << 20;
  /// Codecs that clients may ask for. The first one that a client accepts is its default.
  std::vector<TileCodec> codecs = {TileCodec::kZstd, TileCodec::kRaw, TileCodec::kWebp};
};

}  // namespace mirage
