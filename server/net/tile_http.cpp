#include "server/net/tile_http.h"

#include <fmt/format.h>

namespace mirage {
std::variant<TileAddress, HttpAnswer> read_tile_request(const HttpRequest& request,
                                                        std::uint64_t revision,
                                                        const Access& access, std::int64_t now_s) {
  const std::size_t slash = request.path.rfind('/');
  const std::string folder = request.path.substr(0, slash + 1);
  if (const Result<Grant> may = grant_of(request, folder, access, now_s); !may) {
    return refusal(401, may.error().text, "WWW-Authenticate: Bearer\r\n");
  }
  if (folder != fmt::format("{}{:016x}/", kTilePath, revision)) {
    return refusal(404, fmt::format("this server has revision {:016x}", revision));
  }
  const std::optional<TileAddress> address = parse_tile_address(request.path.substr(slash + 1));
  if (!address) return refusal(404, "this is no tile's address");
  return *address;
}

HttpAnswer tile_answer(GotTile tile, TileCodec codec, bool open, const std::string& if_none_match) {
  switch (tile.reason) {
    case wire::RefusalReason::None:
      break;
    case wire::RefusalReason::Busy:
    case wire::RefusalReason::Late:
      return busy();
    default:
      return refusal(404, "there is no such tile");
  }
  HttpAnswer out;
  const std::string tag = fmt::format("\"{:016x}-{}\"", tile.content_hash, codec_name(codec));
  out.type = "application/octet-stream";
  out.headers = fmt::format("ETag: {}\r\nCache-Control: {}, max-age=31536000, immutable\r\n", tag,
                            open ? "public" : "private");
  if (if_none_match == tag) {
    out.status = 304;
  } else {
    out.body.assign(tile.message.begin(), tile.message.end());
  }
  return out;
}

}  // namespace mirage
