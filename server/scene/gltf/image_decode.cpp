#include "server/scene/gltf/image_decode.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <memory>
#include <vector>

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
bool read_reduced(OIIO::ImageInput& input, const OIIO::ImageSpec& spec, int halvings, bool srgb,
                  Image& image) {
  const std::size_t stride =
      static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels);
  const int step = std::max(1, static_cast<int>((std::size_t{1} << 20) / stride));
  std::vector<std::uint8_t> rows(static_cast<std::size_t>(step) * stride);
  ImageReducer reducer(static_cast<std::uint32_t>(spec.width),
                       static_cast<std::uint32_t>(spec.height), spec.nchannels, halvings, srgb);
  for (int y = 0; y < spec.height; y += step) {
    const int end = std::min(y + step, spec.height);
    if (!input.read_scanlines(0, 0, y, end, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8,
                              rows.data())) {
      return false;
    }
    reducer.add_rows(std::span(rows).first(static_cast<std::size_t>(end - y) * stride));
  }
  image = reducer.take();
  return true;
}

bool read_whole(OIIO::ImageInput& input, const OIIO::ImageSpec& spec, Image& image) {
  image.width = static_cast<std::uint32_t>(spec.width);
  image.height = static_cast<std::uint32_t>(spec.height);
  std::vector<std::uint8_t> pixels(std::size_t{image.width} * image.height *
                                   static_cast<std::size_t>(spec.nchannels));
  if (!input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, pixels.data())) {
    return false;
  }
  image.rgba = spec.nchannels == 4 ? std::move(pixels) : expand(pixels, spec.nchannels);
  return true;
}

Result<Image> decode(std::span<const std::uint8_t> bytes, const ImageHeader& header, int halvings,
                     bool srgb) {
  OIIO::Filesystem::IOMemReader reader(bytes.data(), bytes.size());
  OIIO::ImageSpec config;
  config["oiio:UnassociatedAlpha"] = 1;
  OIIO::Filesystem::IOProxy* proxy = &reader;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  // The header has named the format; if its reader fails, the others are not tried.
  OIIO::attribute("try_all_readers", 0);
  auto input = OIIO::ImageInput::open(file_name(header.format), &config, proxy);
  // The message must be fetched in any case, or OpenImageIO prints it.
  if (!input) return unreadable(OIIO::geterror());
  const OIIO::ImageSpec spec = input->spec();
  const auto width = static_cast<std::uint32_t>(spec.width);
  const auto height = static_cast<std::uint32_t>(spec.height);
  if (width != header.width || height != header.height) return unreadable("contradictory size");
  if (spec.nchannels < 1 || spec.nchannels > kMaxChannels) return unreadable("odd channel count");

  Image image;
  const bool complete = halvings > 0 ? read_reduced(*input, spec, halvings, srgb, image)
                                     : read_whole(*input, spec, image);
  const std::string message = input->geterror();
  input->close();
  if (!complete) return unreadable(message);
  return image;
}

}  // namespace

Result<ImageHeader> judge_image(std::span<const std::uint8_t> bytes) {
  const auto header = peek_image_header(bytes);
  if (!header) return unreadable("neither a whole PNG, nor JPEG, nor WebP");
  if (header->width == 0 || header->height == 0) return unreadable("an image without pixels");
  const bool large = header->pixels() > kMaxImagePixels && !header->streams;
  if (header->width > kMaxImageSide || header->height > kMaxImageSide || large) {
    return make_error(ErrorId::kSceneLimit, std::to_string(header->width) + " x " +
                                                std::to_string(header->height) +
                                                " pixels are too many");
  }
  return *header;
}

Result<Image> decode_image(std::span<const std::uint8_t> bytes, int halvings, bool srgb) {
  const auto header = judge_image(bytes);
  if (!header) return header.error();
  try {
    return decode(bytes, *header, halvings, srgb);
  } catch (const std::exception& exception) {
    return unreadable(exception.what());
  }
}

}  // namespace mirage::gltf
