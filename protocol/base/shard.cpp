#include "protocol/base/shard.h"

#include <charconv>

namespace mirage {
namespace {

constexpr unsigned kMostShards = 999'999;

}  // namespace

Result<Shard> parse_shard(const std::string& text) {
  Shard out;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, out.index);
  const bool slash = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto count = std::from_chars(slash ? index.ptr + 1 : end, end, out.count);
  if (count.ec != std::errc() || count.ptr != end || out.count < 1 || out.count > kMostShards ||
      out.index > out.count) {
    return make_error(ErrorId::kUsage, "'" + text + "' is no shard",
                      "four machines have the shards 1/4, 2/4, 3/4 and 4/4; 0/4 is 4/4");
  }
  out.index %= out.count;
  return out;
}

}  // namespace mirage
