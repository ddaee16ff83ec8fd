#include "server/scene/gltf/image_decode.h"

#include <memory>
#include <vector>

#include "modules/image_library.h"
#include "modules/ktx2_header.h"
#include "modules/ktx2_library.h"
#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/image_reduce.h"

namespace mirage::gltf {
namespace {

constexpr int kMaxChannels = 4;

Error unreadable(const std::string& why) { return make_error(ErrorId::kSceneFormat, why); }

const char* file_name(ImageFormat format) {
  switch (format) {
    case ImageFormat::kPng:
      return "memory.png";
    case ImageFormat::kJpeg:
      return "memory.jpg";
    default:
      return "memory.webp";
  }
}

/// Expands grey, grey-alpha and RGB to RGBA.
std::vector<std::uint8_t> expand(const std::vector<std::uint8_t>& in, int channels) {
  const std::size_t pixels = in.size() / static_cast<std::size_t>(channels);
  std::vector<std::uint8_t> out(pixels * 4);
  const bool grey = channels < 3;
  const bool alpha = channels == 2 || channels == 4;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t* source = &in[i * static_cast<std::size_t>(channels)];
    out[i * 4 + 0] = source[0];
    out[i * 4 + 1] = grey ? source[0] : source[1];
    out[i * 4 + 2] = grey ? source[0] : source[2];
    out[i * 4 + 3] = alpha ? source[channels - 1] : 255;
  }
  return out;
}

/// Reads rows of about a megabyte at a time, so that only the result is in memory as a whole.
Result<Image> read_reduced(ImageReader& input, int halvings, bool srgb) {
  const ImageShape shape = input.shape();
  const std::size_t stride =
      static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.channels);
  const int step = std::max(1, static_cast<int>((std::size_t{1} << 20) / stride));
  std::vector<std::uint8_t> rows(static_cast<std::size_t>(step) * stride);
  ImageReducer reducer(static_cast<std::uint32_t>(shape.width),
                       static_cast<std::uint32_t>(shape.height), shape.channels, halvings, srgb);
  for (int y = 0; y < shape.height; y += step) {
    const int end = std::min(y + step, shape.height);
    const Result<void> read = input.read_rows(y, end, shape.channels, rows.data());
    if (!read) return unreadable(read.error().text);
    reducer.add_rows(std::span(rows).first(static_cast<std::size_t>(end - y) * stride));
  }
  return reducer.take();
}

Result<Image> read_whole(ImageReader& input) {
  const ImageShape shape = input.shape();
  Image image;
  image.width = static_cast<std::uint32_t>(shape.width);
  image.height = static_cast<std::uint32_t>(shape.height);
  std::vector<std::uint8_t> pixels(std::size_t{image.width} * image.height *
                                   static_cast<std::size_t>(shape.channels));
  const Result<void> read = input.read_rows(0, shape.height, shape.channels, pixels.data());
  if (!read) return unreadable(read.error().text);
  image.rgba = shape.channels == 4 ? std::move(pixels) : expand(pixels, shape.channels);
  return image;
}

// Decodes the level of a KTX2 texture that comes nearest, and halves that further.
Result<Image> decode_ktx2(std::span<const std::uint8_t> bytes, int halvings, bool srgb) {
  const Result<const Ktx2Library*> library = ktx2_library();
  if (!library) return library.error();
  const Result<Ktx2Header> header = read_ktx2_header(bytes);
  if (!header) return header.error();
  const auto level = std::min(static_cast<std::uint32_t>(halvings), header->levels - 1);
  Result<Ktx2Pixels> pixels = (*library)->decode(bytes, level);
  if (!pixels) return pixels.error();
  const int left = halvings - static_cast<int>(level);
  if (left == 0) {
    Image image;
    image.width = pixels->width;
    image.height = pixels->height;
    image.rgba = std::move(pixels->rgba);
    return image;
  }
  ImageReducer reducer(pixels->width, pixels->height, kMaxChannels, left, srgb);
  reducer.add_rows(pixels->rgba);
  return reducer.take();
}

Result<Image> decode(std::span<const std::uint8_t> bytes, const ImageHeader& header, int halvings,
                     bool srgb) {
  const Result<const ImageLibrary*> library = image_library();
  if (!library) return library.error();
  const ImageLibrary::Opened input = (*library)->open_bytes(bytes, file_name(header.format));
  if (!input) return unreadable(input.error().text);
  const ImageShape shape = (*input)->shape();
  const auto width = static_cast<std::uint32_t>(shape.width);
  const auto height = static_cast<std::uint32_t>(shape.height);
  if (width != header.width || height != header.height) return unreadable("contradictory size");
  if (shape.channels < 1 || shape.channels > kMaxChannels) return unreadable("odd channel count");
  return halvings > 0 ? read_reduced(**input, halvings, srgb) : read_whole(**input);
}

Result<ImageHeader> read_header(std::span<const std::uint8_t> bytes) {
  const auto header = peek_image_header(bytes);
  if (!header) return unreadable("neither a whole PNG, nor JPEG, nor WebP, nor KTX2");
  if (header->width == 0 || header->height == 0) return unreadable("an image without pixels");
  return *header;
}

}  // namespace

Result<ImageHeader> judge_image(std::span<const std::uint8_t> bytes, const SceneLimits& limits) {
  const auto header = read_header(bytes);
  if (!header) return header;
  if (header->width > kMaxImageSide || header->height > kMaxImageSide) {
    return make_error(ErrorId::kSceneLimit,
                      std::to_string(header->width) + " x " + std::to_string(header->height) +
                          " pixels, at most " + std::to_string(kMaxImageSide) + " a side");
  }
  if (!header->streams && header->pixels() > limits.whole_pixels) {
    return limits.exceeded(header->pixels(), limits.whole_pixels,
                           "pixels in one progressive or interlaced image",
                           "resize IN OUT --width 2048 --height 2048");
  }
  return header;
}

Result<Image> decode_image(std::span<const std::uint8_t> bytes, int halvings, bool srgb) {
  const auto header = read_header(bytes);
  if (!header) return header.error();
  if (header->format == ImageFormat::kKtx2) return decode_ktx2(bytes, halvings, srgb);
  return decode(bytes, *header, halvings, srgb);
}

}  // namespace mirage::gltf
