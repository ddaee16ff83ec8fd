#pragma once
// Small PNG images made in memory.

#include <cstdint>
#include <string>

namespace mirage::test {

inline std::string big_endian(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
          static_cast<char>(value >> 8), static_cast<char>(value)};
}

inline std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

inline std::string png_chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data +
         big_endian(crc32(type + data));
}

/// PNG whose pixels are stored, not compressed. `color_type`: 0 grey, 2 RGB, 4 grey-alpha, 6 RGBA.
inline std::string make_png(std::uint32_t width, std::uint32_t height, int depth, int color_type,
                            const std::string& pixels) {
  std::string rows;
  const std::size_t row = height > 0 ? pixels.size() / height : 0;
  for (std::size_t y = 0; y < height && row > 0; ++y) {
    rows += std::string(1, '\0') + pixels.substr(y * row, row);
  }
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const char c : rows) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  const auto size = static_cast<std::uint16_t>(rows.size());
  const std::string block = {'\1', static_cast<char>(size), static_cast<char>(size >> 8),
                             static_cast<char>(~size), static_cast<char>(~size >> 8)};
  const std::string header = big_endian(width) + big_endian(height) + static_cast<char>(depth) +
                             static_cast<char>(color_type) + std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) +
         png_chunk("IDAT", "\x78\x01" + block + rows + big_endian(b << 16 | a)) +
         png_chunk("IEND", "");
}

}  // namespace mirage::test
