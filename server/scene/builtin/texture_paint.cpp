#include "server/scene/builtin/texture_paint.h"

#include <cmath>
#include <vector>

#include "server/scene/builtin/random.h"

namespace mirage::builtin {
namespace {

constexpr int kCardSide = 128;

/// Linear RGB plus coverage, converted once at the end.
class Canvas {
 public:
  Canvas(int width, int height)
      : width_(width), height_(height), pixels_(static_cast<std::size_t>(width * height)) {}

  glm::vec4& at(int x, int y) { return pixels_[static_cast<std::size_t>(y * width_ + x)]; }

  /// Calls f(x, y, uv of the pixel's centre) for every pixel.
  template <typename F>
  void each(F f) {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        f(x, y,
          glm::vec2((static_cast<float>(x) + 0.5f) / static_cast<float>(width_),
                    (static_cast<float>(y) + 0.5f) / static_cast<float>(height_)));
      }
    }
  }

  void cover(int x, int y, glm::vec3 color, float coverage) {
    glm::vec4& p = at(x, y);
    const float keep = p.a * (1 - coverage);
    const float a = keep + coverage;
    if (a <= 0) return;
    p = glm::vec4((glm::vec3(p) * keep + color * coverage) / a, a);
  }

  /// Gives transparent pixels the mean colour of the covered ones.
  void bleed() {
    glm::vec3 sum(0);
    float weight = 1e-6f;
    for (const glm::vec4& p : pixels_) {
      sum += glm::vec3(p) * p.a;
      weight += p.a;
    }
    for (glm::vec4& p : pixels_) p = glm::vec4(glm::mix(sum / weight, glm::vec3(p), p.a), p.a);
  }

  Image image() const {
    Image image;
    image.width = static_cast<std::uint32_t>(width_);
    image.height = static_cast<std::uint32_t>(height_);
    image.rgba.reserve(pixels_.size() * 4);
    for (const glm::vec4& p : pixels_) {
      for (int c = 0; c < 3; ++c) image.rgba.push_back(srgb_byte(p[c]));
      image.rgba.push_back(static_cast<std::uint8_t>(glm::clamp(p.a, 0.0f, 1.0f) * 255 + 0.5f));
    }
    return image;
  }

 private:
  int width_;
  int height_;
  std::vector<glm::vec4> pixels_;
};

struct Leaf {
  glm::vec2 base;
  glm::vec2 along;  ///< unit
  float length;
  float half_width;
  glm::vec3 color;
  bool lobed;
};

void draw_leaf(Canvas& canvas, const Leaf& leaf) {
  const glm::vec2 across(-leaf.along.y, leaf.along.x);
  const float soft = 1.0f / static_cast<float>(kCardSide);
  canvas.each([&](int x, int y, glm::vec2 uv) {
    const glm::vec2 d = uv - leaf.base;
    const float s = glm::dot(d, leaf.along) / leaf.length;
    if (s <= 0 || s >= 1) return;
    const float t = glm::dot(d, across);
    float half = leaf.half_width * std::sin(3.14159f * std::pow(s, 0.8f));
    if (leaf.lobed) half *= 0.75f + 0.3f * std::sin(s * 22.0f);
    const float edge = glm::clamp((half - std::abs(t)) / soft + 0.5f, 0.0f, 1.0f);
    if (edge <= 0) return;
    const float rib = std::abs(t) < 0.05f * leaf.half_width + 0.002f ? 1.25f : 1.0f;
    const float fold = t > 0 ? 0.85f : 1.05f;
    canvas.cover(x, y, leaf.color * (rib * fold * (0.8f + 0.3f * s)), edge);
  });
}

}  // namespace

std::uint8_t srgb_byte(float linear) {
  const float c = glm::clamp(linear, 0.0f, 1.0f);
  const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(s * 255.0f + 0.5f);
}

Image paint_leaf_cluster(std::uint32_t seed, const LeafStyle& style) {
  Canvas canvas(kCardSide, kCardSide);
  Random random(seed, 11);
  for (int i = 0; i < style.count; ++i) {
    // The golden angle spreads leaves evenly; inner ones are drawn last, on top.
    const float a = 2.39996f * static_cast<float>(i) + random.range(-0.4f, 0.4f);
    const float ring = std::sqrt(1 - static_cast<float>(i) / static_cast<float>(style.count));
    Leaf leaf;
    leaf.length = style.length * random.range(0.8f, 1.15f);
    leaf.half_width = leaf.length * style.width * 0.5f;
    const glm::vec2 out(std::cos(a), std::sin(a));
    leaf.base = glm::vec2(0.5f) + out * (ring * (0.48f - 0.85f * style.length));
    const float turn = a + random.range(-0.7f, 0.7f);
    leaf.along = {std::cos(turn), std::sin(turn)};
    leaf.color = glm::mix(style.dark, style.light, random.unit());
    leaf.lobed = style.lobed;
    draw_leaf(canvas, leaf);
  }
  canvas.bleed();
  return canvas.image();
}

Image paint_needle_frond(std::uint32_t seed, const LeafStyle& style) {
  Canvas canvas(kCardSide, kCardSide);
  Random random(seed, 12);
  for (int i = 0; i < style.count; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(style.count);
    const float side = i % 2 == 0 ? 1.0f : -1.0f;
    Leaf leaf;
    leaf.base = {0.5f + random.range(-0.02f, 0.02f), 0.99f - 0.88f * t};
    const float angle = random.range(0.55f, 0.95f) * (1 - 0.5f * t);
    leaf.along = {side * std::sin(angle), -std::cos(angle)};
    leaf.length = style.length * (1.15f - 0.8f * t) * random.range(0.8f, 1.1f);
    leaf.half_width = leaf.length * style.width * 0.5f + 0.008f;
    leaf.color = glm::mix(style.dark, style.light, random.unit() * (0.4f + 0.6f * t));
    leaf.lobed = false;
    draw_leaf(canvas, leaf);
  }
  draw_leaf(canvas, {{0.5f, 1.0f}, {0, -1}, 1.0f, 0.03f, style.dark, false});
  canvas.bleed();
  return canvas.image();
}

Image paint_grass(std::uint32_t seed, const LeafStyle& style) {
  Canvas canvas(kCardSide, kCardSide);
  Random random(seed, 13);
  for (int i = 0; i < style.count; ++i) {
    Leaf leaf;
    leaf.length = style.length * random.range(0.55f, 1.0f);
    // A negative start hides the blade's rounded foot below the edge.
    leaf.base = {random.range(0.12f, 0.88f), 1.0f + 0.25f * leaf.length};
    const float lean = random.range(-0.35f, 0.35f);
    leaf.along = {std::sin(lean), -std::cos(lean)};
    leaf.half_width = style.width * random.range(0.7f, 1.2f);
    leaf.color = glm::mix(style.dark, style.light, random.unit());
    leaf.lobed = false;
    draw_leaf(canvas, leaf);
  }
  canvas.bleed();
  return canvas.image();
}

Image paint_bark(std::uint32_t seed, glm::vec3 ridge, glm::vec3 crack) {
  Canvas canvas(kCardSide, kCardSide);
  canvas.each([&](int x, int y, glm::vec2 uv) {
    const float bend = value_noise(uv * 4.0f, seed, 4) * 0.25f;
    const float ridges = value_noise(glm::vec2((uv.x + bend) * 16.0f, uv.y * 4.0f), seed + 1, 16);
    const float grain = fractal_noise(uv * glm::vec2(16.0f), seed + 2, 16);
    const float height = glm::smoothstep(0.2f, 0.7f, 0.7f * ridges + 0.3f * grain);
    canvas.at(x, y) = glm::vec4(glm::mix(crack, ridge, height) * (0.75f + 0.5f * grain), 1);
  });
  return canvas.image();
}

Image paint_birch_bark(std::uint32_t seed) {
  Canvas canvas(kCardSide, kCardSide);
  canvas.each([&](int x, int y, glm::vec2 uv) {
    const float stripe = value_noise(uv * glm::vec2(4.0f, 32.0f), seed, 32);
    const float patch = fractal_noise(uv * glm::vec2(4.0f, 8.0f), seed + 1, 8);
    const float dark =
        glm::max(glm::smoothstep(0.74f, 0.86f, stripe), glm::smoothstep(0.66f, 0.76f, patch));
    const glm::vec3 white = glm::vec3(0.72f, 0.70f, 0.64f) * (0.8f + 0.3f * patch);
    canvas.at(x, y) = glm::vec4(glm::mix(white, glm::vec3(0.035f, 0.03f, 0.028f), dark), 1);
  });
  return canvas.image();
}

Image paint_mottle(std::uint32_t seed, float contrast, float frequency) {
  Canvas canvas(256, 256);
  const int period = static_cast<int>(frequency);
  canvas.each([&](int x, int y, glm::vec2 uv) {
    const float n = fractal_noise(uv * static_cast<float>(period), seed, period);
    const float fine = value_noise(uv * 128.0f, seed + 9, 128);
    const float k = 1 - contrast * (0.65f * (1 - n) + 0.35f * fine);
    canvas.at(x, y) = glm::vec4(k * 1.0f, k * 1.0f, k * 0.95f, 1);
  });
  return canvas.image();
}

Image paint_planks(std::uint32_t seed, int boards) {
  Canvas canvas(256, 256);
  canvas.each([&](int x, int y, glm::vec2 uv) {
    const float row = uv.y * static_cast<float>(boards);
    const auto board = static_cast<std::uint32_t>(row);
    Random random(seed, board);
    const float shift = random.unit();
    const float tone = random.range(0.75f, 1.1f);
    const float along = uv.x + shift;
    const float grain = value_noise(glm::vec2(along * 8.0f, row * 9.0f), seed + board);
    const float fine = value_noise(glm::vec2(along * 40.0f, row * 30.0f), seed + 70 + board);
    const float gap_v =
        glm::smoothstep(0.0f, 0.05f, glm::min(glm::fract(row), 1 - glm::fract(row)));
    const float joint = std::abs(glm::fract(along) - 0.5f);
    const float gap = gap_v * glm::smoothstep(0.0f, 0.004f, joint);
    const float k = tone * (0.72f + 0.25f * grain + 0.12f * fine) * (0.45f + 0.55f * gap);
    canvas.at(x, y) = glm::vec4(glm::vec3(0.40f, 0.235f, 0.115f) * k, 1);
  });
  return canvas.image();
}

Image paint_picture(std::uint32_t seed) {
  Canvas canvas(kCardSide, kCardSide);
  Random random(seed, 14);
  const glm::vec3 sky{random.range(0.4f, 0.8f), random.range(0.4f, 0.6f), random.range(0.5f, 0.9f)};
  const glm::vec3 low{random.range(0.6f, 0.9f), random.range(0.35f, 0.6f),
                      random.range(0.1f, 0.4f)};
  const glm::vec3 land{random.range(0.02f, 0.2f), random.range(0.1f, 0.3f),
                       random.range(0.05f, 0.25f)};
  const glm::vec2 sun{random.range(0.2f, 0.8f), random.range(0.15f, 0.4f)};
  canvas.each([&](int x, int y, glm::vec2 uv) {
    glm::vec3 c = glm::mix(sky, low, glm::smoothstep(0.0f, 0.6f, uv.y));
    if (glm::length(uv - sun) < 0.09f) c = {1.0f, 0.9f, 0.6f};
    for (int layer = 0; layer < 4; ++layer) {
      const auto f = static_cast<float>(layer);
      const float ridge =
          0.42f + 0.14f * f - 0.3f * (fractal_noise(glm::vec2(uv.x * (2 + f), f), seed + 5) - 0.4f);
      if (uv.y > ridge) c = glm::mix(low * 0.6f, land, 0.25f + 0.25f * f);
    }
    const float brush = 0.85f + 0.3f * fractal_noise(uv * glm::vec2(14, 40), seed + 8);
    canvas.at(x, y) = glm::vec4(c * brush, 1);
  });
  return canvas.image();
}

Image paint_screen(std::uint32_t seed) {
  Canvas canvas(kCardSide, kCardSide);
  Random random(seed, 15);
  const float split = random.range(0.3f, 0.6f);
  canvas.each([&](int x, int y, glm::vec2 uv) {
    glm::vec3 c = glm::mix(glm::vec3(0.02f, 0.06f, 0.16f), glm::vec3(0.05f, 0.2f, 0.3f), uv.y);
    const bool left = uv.x < split;
    const glm::vec2 in = left ? uv / glm::vec2(split, 1) : (uv - glm::vec2(split, 0)) / (1 - split);
    if (in.x > 0.06f && in.x < 0.94f && uv.y > 0.1f && uv.y < 0.9f) {
      c = left ? glm::vec3(0.012f) : glm::vec3(0.75f);
      if (uv.y < 0.16f) c = glm::vec3(0.2f);
      const auto line = static_cast<std::uint32_t>(uv.y * 32);
      Random text(seed + (left ? 100 : 200), line);
      const float indent = 0.1f + 0.05f * static_cast<float>(text.index(4));
      const float stop = text.range(0.3f, 0.9f);
      const bool ink = uv.y > 0.2f && line % 2 == 0 && in.x > indent && in.x < stop;
      const glm::vec3 tint{text.range(0.1f, 0.6f), text.range(0.3f, 0.6f), text.range(0.1f, 0.6f)};
      if (ink) c = left ? tint : glm::vec3(0.05f);
    }
    canvas.at(x, y) = glm::vec4(c, 1);
  });
  return canvas.image();
}

}  // namespace mirage::builtin
