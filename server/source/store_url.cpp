#include "server/source/store_url.h"

#include <charconv>
#include <optional>

namespace mirage {
namespace {

std::optional<int> number(const std::string& text, int least, int most) {
  int value = 0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || at != end || value < least || value > most) return std::nullopt;
  return value;
}

Error wrong(const std::string& what) {
  return make_error(ErrorId::kUsage, "--store: " + what,
                    "redis://[:PASSWORD@]HOST[:PORT][/DATABASE]");
}

}  // namespace

Result<StoreAddress> parse_store_url(const std::string& url) {
  const std::string scheme = "redis://";
  if (url.rfind(scheme, 0) != 0) return wrong("this is no address of a Redis server");
  StoreAddress out;
  std::string rest = url.substr(scheme.size());
  if (const std::size_t at = rest.rfind('@'); at != std::string::npos) {
    if (rest[0] != ':') return wrong("users other than the default one are not spoken of");
    out.password = rest.substr(1, at - 1);
    rest.erase(0, at + 1);
  }
  if (const std::size_t slash = rest.find('/'); slash != std::string::npos) {
    const std::optional<int> database = number(rest.substr(slash + 1), 0, 1 << 20);
    if (!database) return wrong("'" + rest.substr(slash + 1) + "' is no number of a database");
    out.database = *database;
    rest.erase(slash);
  }
  const std::size_t bracket = rest.find(']');  // an address as [IPv6]:PORT
  const std::size_t colon = rest.find(':', bracket == std::string::npos ? 0 : bracket);
  if (colon != std::string::npos) {
    const std::optional<int> port = number(rest.substr(colon + 1), 1, 65535);
    if (!port) return wrong("'" + rest.substr(colon + 1) + "' is no port");
    out.port = *port;
    rest.erase(colon);
  }
  if (bracket != std::string::npos && rest.front() == '[') rest = rest.substr(1, bracket - 1);
  if (rest.empty()) return wrong("it names no host");
  out.host = rest;
  return out;
}

}  // namespace mirage
