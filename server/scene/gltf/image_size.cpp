#include "server/scene/gltf/image_size.h"

#include <algorithm>
#include <string_view>

namespace mirage::gltf {
namespace {

using ByteSpan = std::span<const std::uint8_t>;

bool has_tag(ByteSpan bytes, std::size_t at, std::string_view tag) {
  if (bytes.size() < at + tag.size()) return false;
  return std::equal(tag.begin(), tag.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

std::uint32_t big_endian(ByteSpan bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + i];
  return value;
}

std::uint32_t little_endian(ByteSpan bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = count - 1; i >= 0; --i) value = value << 8 | bytes[at + i];
  return value;
}

/// True if the chunks reach IEND (ISO/IEC 15948 §5). libpng prints to stderr if they do not.
bool is_whole_png(ByteSpan bytes) {
  std::size_t at = 8;
  while (bytes.size() - at >= 12) {
    if (has_tag(bytes, at + 4, "IEND")) return true;
    const std::size_t length = big_endian(bytes, at, 4);
    if (length > bytes.size() - at - 12) return false;
    at += 12 + length;
  }
  return false;
}

/// Walks the JPEG segments to the start of frame (ITU T.81 §B.2).
std::optional<ImageHeader> peek_jpeg(ByteSpan bytes) {
  std::size_t at = 2;
  while (at + 9 <= bytes.size()) {
    if (bytes[at] != 0xff) return std::nullopt;
    const std::uint8_t marker = bytes[at + 1];
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    const bool is_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (is_frame) {
      return ImageHeader{ImageFormat::kJpeg, big_endian(bytes, at + 7, 2),
                         big_endian(bytes, at + 5, 2), marker == 0xc0 || marker == 0xc1};
    }
    at += 2 + std::max<std::size_t>(big_endian(bytes, at + 2, 2), 2);
  }
  return std::nullopt;
}

/// WebP container: lossy (RFC 6386), lossless and extended first chunks.
std::optional<ImageHeader> peek_webp(ByteSpan bytes) {
  if (bytes.size() < 30) return std::nullopt;
  if (has_tag(bytes, 12, "VP8 ")) {
    return ImageHeader{ImageFormat::kWebp, little_endian(bytes, 26, 2) & 0x3fff,
                       little_endian(bytes, 28, 2) & 0x3fff, false};
  }
  if (has_tag(bytes, 12, "VP8L")) {
    const std::uint32_t bits = little_endian(bytes, 21, 4);
    return ImageHeader{ImageFormat::kWebp, (bits & 0x3fff) + 1, (bits >> 14 & 0x3fff) + 1, false};
  }
  if (has_tag(bytes, 12, "VP8X")) {
    return ImageHeader{ImageFormat::kWebp, little_endian(bytes, 24, 3) + 1,
                       little_endian(bytes, 27, 3) + 1, false};
  }
  return std::nullopt;
}

}  // namespace

std::optional<ImageHeader> peek_image_header(ByteSpan bytes) {
  if (has_tag(bytes, 0, "\x89PNG\r\n\x1a\n")) {
    if (bytes.size() < 29 || !has_tag(bytes, 12, "IHDR")) return std::nullopt;
    if (!is_whole_png(bytes)) return std::nullopt;
    return ImageHeader{ImageFormat::kPng, big_endian(bytes, 16, 4), big_endian(bytes, 20, 4),
                       bytes[28] == 0};
  }
  if (has_tag(bytes, 0, "\xff\xd8\xff")) return peek_jpeg(bytes);
  if (has_tag(bytes, 0, "\xabKTX 20\xbb\r\n\x1a\n") && bytes.size() >= 28) {
    return ImageHeader{ImageFormat::kKtx2, little_endian(bytes, 20, 4), little_endian(bytes, 24, 4),
                       false};
  }
  if (has_tag(bytes, 0, "RIFF") && has_tag(bytes, 8, "WEBP")) return peek_webp(bytes);
  return std::nullopt;
}

}  // namespace mirage::gltf
