#pragma once
// Images on the wire: WebP, in levels of growing size, once per client however many objects use
// them.

#include <array>
#include <optional>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/model/model.h"

namespace mirage {

/// Largest edge of each level; an image has as many as it takes to reach its own size. What exceeds
/// the last one comes reduced to it.
inline constexpr std::array<std::uint32_t, 4> kImageLevelEdges = {64, 256, 1024, 4096};

/// What a client knows of an image before any of it has come.
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

/// What a lossy form of a colour image does to its hue, in 1/255: by mean over 2 x 2 texels, as a
/// filter shows them, weighted by alpha; the larger change of R - G and of B - G.
struct HueError {
  float median = 0;
  float p95 = 0;
};
/// Of two images of one size.
HueError hue_error(const Image& image, const Image& shown);
/// The most that a lossy form may do: a share of what the eye tells apart in large patches, and, at
/// the few texels where colours meet, of what it does not see beside an edge.
inline constexpr HueError kHueLimit{2, 10};

/// Colour in the smallest of few lossy forms that keeps to kHueLimit, alpha exact; without loss
/// where none does, where colours are few (palettes, masks, signs) and for images of at most 64 x
/// 64. Data maps (normals, roughness) without loss. A pure function of its input. Error kCodec.
Result<Bytes> encode_image(const Image& image);
/// The size must be as expected, which is checked before allocating. Error kCodec.
Result<Image> decode_image(const std::uint8_t* bytes, std::size_t size, const glm::uvec2& expected,
                           bool srgb);
/// As its bytes say; nullopt: they are no image, or one larger than any level.
std::optional<glm::uvec2> encoded_image_size(const std::uint8_t* bytes, std::size_t size);

}  // namespace mirage
