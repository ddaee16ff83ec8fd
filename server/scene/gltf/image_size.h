#pragma once
// Width and height of an encoded image from its first bytes, without a decoder. Decoders allocate
// by these numbers, so they are checked first.

#include <cstdint>
#include <optional>
#include <span>

namespace mirage::gltf {

enum class ImageFormat { kPng, kJpeg, kWebp, kKtx2 };

struct ImageHeader {
  ImageFormat format = ImageFormat::kPng;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  /// True if decoders output rows without holding the whole image: neither interlaced nor
  /// progressive.
  bool streams = false;

  std::uint64_t pixels() const { return std::uint64_t{width} * height; }
};

/// Returns the header; nullopt if the bytes are none of the four formats, end before the size, or
/// are a truncated PNG.
std::optional<ImageHeader> peek_image_header(std::span<const std::uint8_t> bytes);

}  // namespace mirage::gltf
