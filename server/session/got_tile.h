#pragma once
// The result of a tile request by HTTP.

#include <cstdint>

#include "protocol/base/bytes.h"
#include "protocol/wire/message.h"

namespace mirage {

struct GotTile {
  std::uint32_t request = 0;
  Bytes message;  ///< a TileReply without times and request id; empty: refused
  std::uint64_t content_hash = 0;
  wire::RefusalReason reason = wire::RefusalReason::None;
};

}  // namespace mirage
