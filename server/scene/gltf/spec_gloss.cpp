#include "server/scene/gltf/spec_gloss.h"

#include <algorithm>
#include <cmath>

#include "server/scene/gltf/srgb_table.h"

namespace mirage::gltf {
namespace {

constexpr float kDielectric = 0.04f;
constexpr float kLeast = 1e-6f;

float brightness(const glm::vec3& c) {
  return std::sqrt(0.299f * c.x * c.x + 0.587f * c.y * c.y + 0.114f * c.z * c.z);
}

float largest(const glm::vec3& c) { return std::max({c.x, c.y, c.z}); }

float solve_metallic(float diffuse, float specular, float left_of_specular) {
  if (specular < kDielectric) return 0;
  const float a = kDielectric;
  const float b = diffuse * left_of_specular / (1 - kDielectric) + specular - 2 * kDielectric;
  const float c = kDielectric - specular;
  const float root = std::sqrt(std::max(b * b - 4 * a * c, 0.0f));
  return std::clamp((-b + root) / (2 * a), 0.0f, 1.0f);
}

/// Reads texels as 0..1, interpolated if another image of the pair is larger.
class Sampler {
 public:
  Sampler(const Image* image, std::uint32_t width, std::uint32_t height)
      : image_(image), width_(width), height_(height) {}

  /// Returns colour as light, and alpha unchanged.
  glm::vec4 at(std::uint32_t x, std::uint32_t y) const {
    if (image_ == nullptr) return glm::vec4(1);
    if (image_->width == width_ && image_->height == height_) return texel(x, y);
    const float u = place(x, width_, image_->width);
    const float v = place(y, height_, image_->height);
    const auto left = static_cast<std::uint32_t>(u);
    const auto top = static_cast<std::uint32_t>(v);
    const std::uint32_t right = std::min(left + 1, image_->width - 1);
    const std::uint32_t bottom = std::min(top + 1, image_->height - 1);
    const float s = u - static_cast<float>(left);
    return glm::mix(glm::mix(texel(left, top), texel(right, top), s),
                    glm::mix(texel(left, bottom), texel(right, bottom), s),
                    v - static_cast<float>(top));
  }

 private:
  /// Returns the middle of texel `i` of `of`, in texels of a side of `size`.
  static float place(std::uint32_t i, std::uint32_t of, std::uint32_t size) {
    const float at =
        (static_cast<float>(i) + 0.5f) * static_cast<float>(size) / static_cast<float>(of) - 0.5f;
    return std::clamp(at, 0.0f, static_cast<float>(size - 1));
  }
  glm::vec4 texel(std::uint32_t x, std::uint32_t y) const {
    const std::uint8_t* t = &image_->rgba[(std::size_t{y} * image_->width + x) * 4];
    return {color_[t[0]], color_[t[1]], color_[t[2]], plain_[t[3]]};
  }

  const Image* image_;
  std::uint32_t width_, height_;
  const std::array<float, 256>& color_ = from_byte(true);
  const std::array<float, 256>& plain_ = from_byte(false);
};

Image blank(std::uint32_t width, std::uint32_t height, bool srgb) {
  Image image;
  image.width = width;
  image.height = height;
  image.srgb = srgb;
  image.rgba.resize(std::size_t{width} * height * 4);
  return image;
}

}  // namespace

MetalRough metal_rough_of(const glm::vec3& diffuse, const glm::vec3& specular, float glossiness) {
  const float left = 1 - largest(specular);
  MetalRough out;
  out.roughness = 1 - glossiness;
  out.metallic = solve_metallic(brightness(diffuse), brightness(specular), left);
  const glm::vec3 of_diffuse =
      diffuse * (left / (1 - kDielectric) / std::max(1 - out.metallic, kLeast));
  const glm::vec3 of_specular =
      (specular - glm::vec3(kDielectric * (1 - out.metallic))) / std::max(out.metallic, kLeast);
  out.base = glm::clamp(glm::mix(of_diffuse, of_specular, out.metallic * out.metallic),
                        glm::vec3(0), glm::vec3(1));
  return out;
}

bool never_metal(const glm::vec3& specular) { return brightness(specular) < kDielectric; }

MetalRoughImages convert_images(const Image* diffuse, const Image* specular_glossiness,
                                const SpecGloss& factors) {
  std::uint32_t width = 1;
  std::uint32_t height = 1;
  for (const Image* image : {diffuse, specular_glossiness}) {
    if (image == nullptr) continue;
    width = std::max(width, image->width);
    height = std::max(height, image->height);
  }
  const Sampler diffuse_at(diffuse, width, height);
  const Sampler specular_at(specular_glossiness, width, height);
  const std::vector<std::uint8_t>& color = to_byte(true);
  const std::vector<std::uint8_t>& plain = to_byte(false);
  MetalRoughImages out{blank(width, height, true), blank(width, height, false)};
  std::uint8_t* base = out.base.rgba.data();
  std::uint8_t* data = out.metal_rough.rgba.data();
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x, base += 4, data += 4) {
      const glm::vec4 d = diffuse_at.at(x, y);
      const glm::vec4 s = specular_at.at(x, y);
      const MetalRough texel =
          metal_rough_of(glm::vec3(d) * glm::vec3(factors.diffuse), glm::vec3(s) * factors.specular,
                         s.w * factors.glossiness);
      for (int c = 0; c < 3; ++c) base[c] = byte_of(texel.base[c], color);
      base[3] = byte_of(d.w, plain);
      data[0] = 255;
      data[1] = byte_of(texel.roughness, plain);
      data[2] = byte_of(texel.metallic, plain);
      data[3] = 255;
    }
  }
  return out;
}

}  // namespace mirage::gltf
