#pragma once
// Tiles by HTTP, without sockets: parses requests and builds answers.
//
//   GET /v1/tile/REVISION/ADDRESS[?until=SECONDS&signature=HEX]
//
// A tile never changes, so an answer may be cached for ever; if tokens are needed, only by the
// client that asked. A request then carries a token (Authorization: Bearer TOKEN), or its address
// is signed.

#include <cstdint>
#include <string>
#include <variant>

#include "protocol/wire/tile_address.h"
#include "server/net/http_answer.h"
#include "server/session/got_tile.h"

namespace mirage {

inline constexpr const char* kTilePath = "/v1/tile/";

/// Returns the address of the requested tile, or the answer that refuses: 404 for an unknown one,
/// 401 without a valid token or signature.
std::variant<TileAddress, HttpAnswer> read_tile_request(const HttpRequest& request,
                                                        std::uint64_t revision,
                                                        const Access& access, std::int64_t now_s);
/// Returns the answer for a tile. `open`: no token is needed. `if_none_match`: the header's value.
HttpAnswer tile_answer(GotTile tile, TileCodec codec, bool open, const std::string& if_none_match);

}  // namespace mirage
