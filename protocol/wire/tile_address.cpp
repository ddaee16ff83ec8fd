#include "protocol/wire/tile_address.h"

#include <charconv>
#include <vector>

namespace mirage {
namespace {

constexpr std::size_t kLongest = 128;

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> out(1);
  for (const char c : text) {
    if (c == '.') {
      out.emplace_back();
    } else {
      out.back() += c;
    }
  }
  return out;
}

template <typename T>
bool read(const std::string& text, T& value) {
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && at == end;
}

}  // namespace

std::string TileAddress::text() const {
  std::string out;
  const auto put = [&](std::int64_t number) { out += std::to_string(number) + "."; };
  put(instance);
  put(cell.level);
  put(cell.x);
  put(cell.y);
  put(distance.level);
  put(distance.index);
  put(size_class);
  put(channels);
  if (phase != 0) put(phase);
  return out + codec_name(codec);
}

std::optional<TileAddress> parse_tile_address(const std::string& text) {
  if (text.size() > kLongest) return std::nullopt;
  const std::vector<std::string> parts = parts_of(text);
  if (parts.size() != 9 && parts.size() != 10) return std::nullopt;
  TileAddress out;
  bool right = read(parts[0], out.instance) && read(parts[1], out.cell.level) &&
               read(parts[2], out.cell.x) && read(parts[3], out.cell.y) &&
               read(parts[4], out.distance.level) && read(parts[5], out.distance.index) &&
               read(parts[6], out.size_class) && read(parts[7], out.channels);
  if (parts.size() == 10) right = right && read(parts[8], out.phase);
  const std::optional<TileCodec> codec = codec_from_name(parts.back());
  if (!right || !codec) return std::nullopt;
  out.codec = *codec;
  if (out.text() != text) return std::nullopt;  // rejects 007, -0 and an explicit phase 0
  return out;
}

}  // namespace mirage
