#include "protocol/base/shard.h"

#include <cctype>
#include <cstdio>

namespace mirage {

Result<Shard> parse_shard(const std::string& text) {
  Shard out;
  char extra = 0;
  const bool digit = !text.empty() && std::isdigit(static_cast<unsigned char>(text[0])) != 0;
  if (!digit || std::sscanf(text.c_str(), "%6u/%6u%c", &out.index, &out.count, &extra) != 2 ||
      out.count < 1 || out.index > out.count) {
    return make_error(ErrorId::kUsage, "'" + text + "' is no shard",
                      "four machines have the shards 1/4, 2/4, 3/4 and 4/4; 0/4 is 4/4");
  }
  out.index %= out.count;
  return out;
}

}  // namespace mirage
