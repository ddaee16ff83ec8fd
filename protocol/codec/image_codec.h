#pragma once
// Images on the wire: WebP in levels of growing size. A client gets each image once, however many
// objects use it.

#include <array>
#include <optional>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/model/model.h"

namespace mirage {

/// Largest edge of each level, texels. An image has as many levels as it takes to reach its own
/// size; a larger image is reduced to the last level.
inline constexpr std::array<std::uint32_t, 4> kImageLevelEdges = {64, 256, 1024, 4096};

/// Facts of an image that a client knows before any level arrives.
struct ImageDescription {
  std::uint32_t width = 1;  ///< of the full image
  std::uint32_t height = 1;
  bool srgb = true;
  std::array<std::uint8_t, 4> mean{128, 128, 128, 255};  ///< as the image's own values
  float alpha_cutoff = 0;  ///< of the alpha-tested material that uses it; 0: none does
};

std::uint8_t image_levels(const ImageDescription& image);
/// Size of a level: the full one halved until its larger edge fits.
glm::uvec2 image_level_size(const ImageDescription& image, std::uint8_t level);

/// Hue error of a lossy form of a colour image, in 1/255. It is the larger change of R - G and of B
/// - G, measured on means over 2 x 2 texels (as a filter shows them), weighted by alpha.
struct HueError {
  float median = 0;
  float p95 = 0;
};
/// Compares two images of the same size.
HueError hue_error(const Image& image, const Image& shown);
/// Largest hue error that a lossy form may have. The median limit is a fraction of what the eye
/// distinguishes in large patches. The p95 limit covers the few texels where colours meet; beside
/// an edge the eye misses such an error.
inline constexpr HueError kHueLimit{2, 10};

/// Encodes an image. A colour image takes the smallest of a few lossy forms within kHueLimit, with
/// exact alpha. It is lossless if no form is within, if colours are few (palettes, masks, signs),
/// or up to 64 x 64 texels. Data maps (normals, roughness) are lossless. A pure function. Error
/// kCodec.
Result<Bytes> encode_image(const Image& image);
/// Decodes an image. The size must be the expected one, which is checked before allocating. Error
/// kCodec.
Result<Image> decode_image(const std::uint8_t* bytes, std::size_t size, const glm::uvec2& expected,
                           bool srgb);
/// Returns the size that the bytes state; nullopt if they are no image or exceed the largest level.
std::optional<glm::uvec2> encoded_image_size(const std::uint8_t* bytes, std::size_t size);

}  // namespace mirage
