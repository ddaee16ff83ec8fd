#include "server/net/tile_http.h"

#include <fmt/format.h>

#include <charconv>

namespace mirage {
namespace {

HttpAnswer refusal(unsigned int status, const std::string& text, const std::string& headers = "") {
  return {status, "text/plain", headers, text + "\n"};
}

// Returns the value of `name` in `a=1&b=2`; empty: it is absent.
std::string value_of(const std::string& query, const std::string& name) {
  std::size_t from = 0;
  while (from <= query.size()) {
    const std::size_t end = std::min(query.find('&', from), query.size());
    const std::string part = query.substr(from, end - from);
    if (part.rfind(name + "=", 0) == 0) return part.substr(name.size() + 1);
    from = end + 1;
  }
  return "";
}

Result<void> may_get(const TileRequest& request, const std::string& folder, const Access& access,
                     std::int64_t now_s) {
  const std::string bearer = "Bearer ";
  if (access.open()) return {};
  if (request.authorization.rfind(bearer, 0) == 0) {
    const Result<Grant> grant = access.check(request.authorization.substr(bearer.size()), now_s);
    if (!grant) return grant.error();
    return {};
  }
  const std::string until = value_of(request.query, "until");
  std::int64_t until_s = 0;
  std::from_chars(until.data(), until.data() + until.size(), until_s);
  return access.check_path(folder, until_s, value_of(request.query, "signature"), now_s);
}

}  // namespace

std::variant<TileAddress, HttpAnswer> read_tile_request(const TileRequest& request,
                                                        std::uint64_t revision,
                                                        const Access& access, std::int64_t now_s) {
  const std::size_t slash = request.path.rfind('/');
  const std::string folder = request.path.substr(0, slash + 1);
  if (const Result<void> may = may_get(request, folder, access, now_s); !may) {
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
      return refusal(503, "busy: come back in a second", "Retry-After: 1\r\n");
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
