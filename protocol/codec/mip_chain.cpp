#include "protocol/codec/mip_chain.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mirage {
namespace {

struct LinearImage {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec4> texels;  ///< straight alpha, linear light
};

float srgb_to_linear(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}
float linear_to_srgb(float v) {
  return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}

std::array<float, 256> linear_table(bool srgb) {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < 256; ++i) {
    const float v = static_cast<float>(i) / 255.0f;
    table[i] = srgb ? srgb_to_linear(v) : v;
  }
  return table;
}

LinearImage to_linear(const Image& image) {
  const std::array<float, 256> table = linear_table(image.srgb);
  LinearImage out{image.width, image.height, {}};
  out.texels.reserve(image.rgba.size() / 4);
  for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4) {
    const std::uint8_t* p = &image.rgba[i];
    out.texels.emplace_back(table[p[0]], table[p[1]], table[p[2]],
                            static_cast<float>(p[3]) / 255.0f);
  }
  return out;
}

LinearImage half(const LinearImage& in) {
  LinearImage out{std::max(in.width / 2, 1u), std::max(in.height / 2, 1u), {}};
  out.texels.reserve(std::size_t{out.width} * out.height);
  for (std::uint32_t y = 0; y < out.height; ++y) {
    for (std::uint32_t x = 0; x < out.width; ++x) {
      glm::vec3 color(0), plain(0);
      float alpha = 0;
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t sx = std::min(2 * x + k % 2, in.width - 1);
        const std::uint32_t sy = std::min(2 * y + k / 2, in.height - 1);
        const glm::vec4& t = in.texels[std::size_t{sy} * in.width + sx];
        color += glm::vec3(t) * t.a;
        plain += glm::vec3(t);
        alpha += t.a;
      }
      // The plain mean is used if all texels are transparent, because their colour bleeds into
      // edges.
      const glm::vec3 mean = alpha > 0 ? color / alpha : plain / 4.0f;
      out.texels.emplace_back(mean, alpha / 4.0f);
    }
  }
  return out;
}

std::vector<float> rising_alphas(const LinearImage& image) {
  std::vector<float> out;
  out.reserve(image.texels.size());
  for (const glm::vec4& t : image.texels) out.push_back(t.a);
  std::sort(out.begin(), out.end());
  return out;
}

// Returns the share of texels that reach the cutoff when their alpha is scaled.
double coverage(const std::vector<float>& rising, float cutoff, float scale) {
  const auto first = std::partition_point(rising.begin(), rising.end(),
                                          [&](float alpha) { return alpha * scale < cutoff; });
  return static_cast<double>(rising.end() - first) / static_cast<double>(rising.size());
}

float scale_for_coverage(const LinearImage& image, float cutoff, double target) {
  const std::vector<float> rising = rising_alphas(image);
  float low = 0.25f, high = 8.0f;
  for (int i = 0; i < 16; ++i) {
    const float middle = 0.5f * (low + high);
    (coverage(rising, cutoff, middle) < target ? low : high) = middle;
  }
  return high;
}

Image to_bytes(const LinearImage& in, bool srgb, float alpha_scale) {
  Image out;
  out.width = in.width;
  out.height = in.height;
  out.srgb = srgb;
  out.rgba.reserve(in.texels.size() * 4);
  const auto byte = [](float v) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f));
  };
  for (const glm::vec4& t : in.texels) {
    for (int c = 0; c < 3; ++c) out.rgba.push_back(byte(srgb ? linear_to_srgb(t[c]) : t[c]));
    out.rgba.push_back(byte(t.a * alpha_scale));
  }
  return out;
}

}  // namespace

std::vector<Image> alpha_preserving_mips(const Image& image, float cutoff) {
  std::vector<Image> out;
  LinearImage level = to_linear(image);
  const double target = coverage(rising_alphas(level), cutoff, 1.0f);
  while (level.width > 1 || level.height > 1) {
    level = half(level);
    out.push_back(to_bytes(level, image.srgb, scale_for_coverage(level, cutoff, target)));
  }
  return out;
}

Image reduced_image(const Image& image, const glm::uvec2& size, float cutoff) {
  if (size == glm::uvec2(image.width, image.height)) return image;
  const std::array<float, 256> table = linear_table(image.srgb);
  const bool weighted = cutoff > 0;
  LinearImage out{size.x, size.y, {}};
  out.texels.reserve(std::size_t{size.x} * size.y);
  for (std::uint32_t y = 0; y < size.y; ++y) {
    const std::uint32_t y0 = y * image.height / size.y, y1 = (y + 1) * image.height / size.y;
    for (std::uint32_t x = 0; x < size.x; ++x) {
      const std::uint32_t x0 = x * image.width / size.x, x1 = (x + 1) * image.width / size.x;
      glm::vec3 color(0), plain(0);
      float alpha = 0;
      for (std::uint32_t sy = y0; sy < y1; ++sy) {
        for (std::uint32_t sx = x0; sx < x1; ++sx) {
          const std::uint8_t* t = &image.rgba[(std::size_t{sy} * image.width + sx) * 4];
          const glm::vec3 c(table[t[0]], table[t[1]], table[t[2]]);
          const float a = static_cast<float>(t[3]) / 255.0f;
          if (weighted) color += c * a;
          plain += c;
          alpha += a;
        }
      }
      const auto n = static_cast<float>((x1 - x0) * (y1 - y0));
      out.texels.emplace_back(weighted && alpha > 0 ? color / alpha : plain / n, alpha / n);
    }
  }
  if (!weighted) return to_bytes(out, image.srgb, 1.0f);
  std::size_t covered = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) {
    covered += static_cast<float>(image.rgba[i]) / 255.0f >= cutoff;
  }
  const double target = 4.0 * static_cast<double>(covered) / static_cast<double>(image.rgba.size());
  return to_bytes(out, image.srgb, scale_for_coverage(out, cutoff, target));
}

}  // namespace mirage
