#include "server/net/websocket_rules.h"

#include <algorithm>
#include <cctype>

namespace mirage {

bool is_upgrade_key(const std::string& key) {
  constexpr std::size_t kDigits = 22;  // 16 bytes; two padding signs follow
  if (key.size() != kDigits + 2 || key.compare(kDigits, 2, "==") != 0) return false;
  return std::all_of(key.begin(), key.begin() + kDigits,
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '+' || c == '/'; });
}

bool is_close_body(const std::uint8_t* body, std::size_t bytes) {
  if (bytes == 0) return true;
  if (bytes == 1) return false;
  const int code = body[0] << 8 | body[1];
  const bool reserved = code == 1004 || code == 1005 || code == 1006 || code == 1015;
  return (code >= 1000 && code <= 1015 && !reserved) || (code >= 3000 && code <= 4999);
}

}  // namespace mirage
