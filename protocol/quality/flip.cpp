#include "protocol/quality/flip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/quality/flip_filter.h"

namespace mirage {
namespace {

using flip::CsfFilter;
using flip::FeatureKernels;
using flip::Plane;

// The letters behind these constants are the paper's names.
constexpr float kColorExponent = 0.7f;    // q_c
constexpr float kColorKnee = 0.4f;        // p_c
constexpr float kColorKneeValue = 0.95f;  // p_t
constexpr float kFeatureExponent = 0.5f;  // q_f
constexpr float kInverseSqrt2 = 0.70710678f;

struct Rgb {
  float r, g, b;
};
/// XYZ divided by the white point D65, so that white is (1, 1, 1).
struct Xyz {
  float x, y, z;
};
struct Lab {
  float l, a, b;
};

// Converts linear sRGB to XYZ; the rows of the matrix are divided by their sum (the white point).
Xyz xyz_from_linear(const Rgb& c) {
  constexpr double kX = 10135552.0 + 8788810.0 + 4435075.0;
  constexpr double kY = 2613072.0 + 8788810.0 + 887015.0;
  constexpr double kZ = 1425312.0 + 8788810.0 + 70074185.0;
  constexpr auto kXr = static_cast<float>(10135552.0 / kX),
                 kXg = static_cast<float>(8788810.0 / kX), kXb = static_cast<float>(4435075.0 / kX);
  constexpr auto kYr = static_cast<float>(2613072.0 / kY), kYg = static_cast<float>(8788810.0 / kY),
                 kYb = static_cast<float>(887015.0 / kY);
  constexpr auto kZr = static_cast<float>(1425312.0 / kZ), kZg = static_cast<float>(8788810.0 / kZ),
                 kZb = static_cast<float>(70074185.0 / kZ);
  return {kXr * c.r + kXg * c.g + kXb * c.b, kYr * c.r + kYg * c.g + kYb * c.b,
          kZr * c.r + kZg * c.g + kZb * c.b};
}

// Inverts the matrix above: the reference's XYZ to linear sRGB times the white point.
Rgb linear_from_xyz(const Xyz& c) {
  constexpr float kWx = 0.950428545f, kWz = 1.088900371f;
  const float x = c.x * kWx, y = c.y, z = c.z * kWz;
  return {3.241003275f * x - 1.537398934f * y - 0.498615861f * z,
          -0.969224334f * x + 1.875930071f * y + 0.041554224f * z,
          0.055639423f * x - 0.204011202f * y + 1.057148933f * z};
}

float lab_curve(float t) {
  constexpr float kDelta = 6.0f / 29.0f;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
}

/// CIE L*a*b*, with chroma scaled by lightness (Hunt effect).
Lab hunt_lab_from_linear(const Rgb& c) {
  const Xyz xyz = xyz_from_linear(c);
  const float fx = lab_curve(xyz.x), fy = lab_curve(xyz.y), fz = lab_curve(xyz.z);
  const float l = 116.0f * fy - 16.0f;
  return {l, 0.01f * l * 500.0f * (fx - fy), 0.01f * l * 200.0f * (fy - fz)};
}

float hyab(const Lab& p, const Lab& q) {
  const float da = p.a - q.a, db = p.b - q.b;
  return std::abs(p.l - q.l) + std::sqrt(da * da + db * db);
}

/// Maps a HyAB distance to 0..1: compressed by q_c, then a knee that leaves 5 % for the largest
/// errors.
float color_error(float distance, float largest) {
  const float p = std::pow(distance, kColorExponent);
  const float knee = kColorKnee * largest;
  if (p < knee) return kColorKneeValue / knee * p;
  return kColorKneeValue + (p - knee) / (largest - knee) * (1.0f - kColorKneeValue);
}

std::array<float, 256> linear_from_srgb_table() {
  std::array<float, 256> table{};
  for (int i = 0; i < 256; ++i) {
    const double s = i / 255.0;
    table[i] = static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
  }
  return table;
}

/// A picture in the opponent space YCxCz.
struct Opponent {
  Plane y, cx, cz;
};

Opponent opponent_from_image(const ImageView& image) {
  static const std::array<float, 256> kLinear = linear_from_srgb_table();
  Opponent out{Plane(image.width, image.height), Plane(image.width, image.height),
               Plane(image.width, image.height)};
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const std::uint8_t* p = image.rgba + i * 4;
    const Xyz c = xyz_from_linear({kLinear[p[0]], kLinear[p[1]], kLinear[p[2]]});
    out.y.values[i] = 116.0f * c.y - 16.0f;
    out.cx.values[i] = 500.0f * (c.x - c.y);
    out.cz.values[i] = 200.0f * (c.y - c.z);
  }
  return out;
}

struct CsfFilters {
  CsfFilter y, cx, cz;
};

CsfFilters csf_filters(double pixels_per_degree) {
  return {flip::csf_filter({{1.0, 0.0047}}, pixels_per_degree),
          flip::csf_filter({{1.0, 0.0053}}, pixels_per_degree),
          flip::csf_filter({{34.1, 0.04}, {13.5, 0.025}}, pixels_per_degree)};
}

/// Returns the colours that can be seen at this viewing distance.
std::vector<Lab> perceived_colors(const Opponent& image, const CsfFilters& filters) {
  const Plane y = flip::apply(filters.y, image.y);
  const Plane cx = flip::apply(filters.cx, image.cx);
  const Plane cz = flip::apply(filters.cz, image.cz);
  std::vector<Lab> out(y.values.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float luminance = (y.values[i] + 16.0f) / 116.0f;
    const Rgb rgb = linear_from_xyz(
        {luminance + cx.values[i] / 500.0f, luminance, luminance - cz.values[i] / 200.0f});
    out[i] = hunt_lab_from_linear({std::clamp(rgb.r, 0.0f, 1.0f), std::clamp(rgb.g, 0.0f, 1.0f),
                                   std::clamp(rgb.b, 0.0f, 1.0f)});
  }
  return out;
}

/// Strength of edges and of points in the achromatic channel.
struct Features {
  Plane edge, point;
};

Plane magnitude(const Plane& a, const Plane& b) {
  Plane out(a.width, a.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    out.values[i] = std::sqrt(a.values[i] * a.values[i] + b.values[i] * b.values[i]);
  }
  return out;
}

Features features(const Plane& achromatic, const FeatureKernels& k) {
  Plane y = achromatic;
  for (float& v : y.values) v = (v + 16.0f) / 116.0f;
  const Plane smooth_columns = flip::convolve_columns(y, k.smooth);
  const Plane smooth_rows = flip::convolve_rows(y, k.smooth);
  return {magnitude(flip::convolve_rows(smooth_columns, k.edge),
                    flip::convolve_columns(smooth_rows, k.edge)),
          magnitude(flip::convolve_rows(smooth_columns, k.point),
                    flip::convolve_columns(smooth_rows, k.point))};
}

}  // namespace

std::optional<FlipMap> flip_map(const ImageView& reference, const ImageView& test,
                                double pixels_per_degree) {
  const bool density = std::isfinite(pixels_per_degree) && pixels_per_degree > 0;
  if (!comparable(reference, test) || reference.pixels() == 0 || !density) return std::nullopt;
  const Opponent a = opponent_from_image(reference), b = opponent_from_image(test);
  const CsfFilters filters = csf_filters(pixels_per_degree);
  const std::vector<Lab> color_a = perceived_colors(a, filters);
  const std::vector<Lab> color_b = perceived_colors(b, filters);
  const FeatureKernels kernels = flip::feature_kernels(pixels_per_degree);
  const Features feature_a = features(a.y, kernels), feature_b = features(b.y, kernels);
  // Green against blue is the largest distance inside the sRGB gamut.
  const float largest = std::pow(
      hyab(hunt_lab_from_linear({0, 1, 0}), hunt_lab_from_linear({0, 0, 1})), kColorExponent);
  FlipMap map{reference.width, reference.height, std::vector<float>(reference.pixels())};
  for (std::size_t i = 0; i < map.error.size(); ++i) {
    const float color = color_error(hyab(color_a[i], color_b[i]), largest);
    const float edge = std::abs(feature_a.edge.values[i] - feature_b.edge.values[i]);
    const float point = std::abs(feature_a.point.values[i] - feature_b.point.values[i]);
    const float feature = std::pow(kInverseSqrt2 * std::max(edge, point), kFeatureExponent);
    map.error[i] = std::pow(color, 1.0f - std::min(feature, 1.0f));
  }
  return map;
}

std::optional<double> flip_mean(const FlipMap& map) {
  return flip_mean(map, full_mask(map.width, map.height));
}

std::optional<double> flip_mean(const FlipMap& map, const Mask& mask) {
  if (mask.inside.size() != map.error.size()) return std::nullopt;
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < map.error.size(); ++i) {
    if (mask.inside[i] == 0) continue;
    sum += static_cast<double>(map.error[i]);
    ++n;
  }
  if (n == 0) return std::nullopt;
  return sum / static_cast<double>(n);
}

std::optional<double> flip_max(const FlipMap& map, const Mask& mask) {
  if (mask.inside.size() != map.error.size()) return std::nullopt;
  std::optional<double> largest;
  for (std::size_t i = 0; i < map.error.size(); ++i) {
    if (mask.inside[i] == 0) continue;
    largest = std::max(largest.value_or(0.0), static_cast<double>(map.error[i]));
  }
  return largest;
}

std::optional<double> flip_quantile(const FlipMap& map, const Mask& mask, double q) {
  if (mask.inside.size() != map.error.size()) return std::nullopt;
  std::vector<float> inside;
  for (std::size_t i = 0; i < map.error.size(); ++i) {
    if (mask.inside[i] != 0) inside.push_back(map.error[i]);
  }
  if (inside.empty()) return std::nullopt;
  const auto rank = static_cast<std::ptrdiff_t>(
      std::lround(std::clamp(q, 0.0, 1.0) * static_cast<double>(inside.size() - 1)));
  std::nth_element(inside.begin(), inside.begin() + rank, inside.end());
  return inside[static_cast<std::size_t>(rank)];
}

std::optional<PicturePlace> flip_worst_place(const FlipMap& map, std::uint32_t edge) {
  if (map.width == 0 || map.height == 0 || edge == 0) return std::nullopt;
  const std::size_t w = map.width, h = map.height;
  const std::size_t across = std::min<std::size_t>(edge, w), down = std::min<std::size_t>(edge, h);
  std::vector<double> column(w, 0);  // sums of the rows that the square covers
  std::optional<PicturePlace> worst;
  for (std::size_t y = 0; y < h; ++y) {
    for (std::size_t x = 0; x < w; ++x) {
      column[x] += map.error[y * w + x];
      if (y >= down) column[x] -= map.error[(y - down) * w + x];
    }
    if (y + 1 < down) continue;
    double sum = 0;
    for (std::size_t x = 0; x < w; ++x) {
      sum += column[x];
      if (x >= across) sum -= column[x - across];
      if (x + 1 < across) continue;
      const double mean = std::max(0.0, sum / static_cast<double>(across * down));
      if (worst && mean <= worst->flip) continue;
      worst = PicturePlace{
          (static_cast<double>(x + 1) - 0.5 * static_cast<double>(across)) / static_cast<double>(w),
          (static_cast<double>(y + 1) - 0.5 * static_cast<double>(down)) / static_cast<double>(h),
          mean};
    }
  }
  return worst;
}

std::vector<std::uint8_t> heat_map(const FlipMap& map) {
  static constexpr std::array<std::array<float, 3>, 5> kColors = {
      {{0, 0, 4}, {81, 18, 124}, {183, 55, 121}, {252, 137, 97}, {252, 253, 191}}};
  std::vector<std::uint8_t> out(4 * map.error.size(), 255);
  for (std::size_t p = 0; p < map.error.size(); ++p) {
    const float at = std::clamp(map.error[p] / kMostFlip, 0.0f, 1.0f) * 4;
    const auto i = std::min<std::size_t>(3, static_cast<std::size_t>(at));
    const float share = at - static_cast<float>(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const float value = kColors[i][k] * (1 - share) + kColors[i + 1][k] * share;
      out[4 * p + k] = static_cast<std::uint8_t>(std::lround(value));
    }
  }
  return out;
}

std::optional<FlipQuartiles> flip_quartiles(const FlipMap& map, const Mask& mask) {
  if (mask.inside.size() != map.error.size()) return std::nullopt;
  std::vector<float> sorted;
  double total = 0;
  for (std::size_t i = 0; i < map.error.size(); ++i) {
    if (mask.inside[i] == 0) continue;
    sorted.push_back(map.error[i]);
    total += static_cast<double>(map.error[i]);
  }
  if (sorted.empty()) return std::nullopt;
  std::sort(sorted.begin(), sorted.end());
  FlipQuartiles out;
  double* const targets[] = {&out.first, &out.median, &out.third};
  int next = 0;
  double sum = 0;
  for (const float v : sorted) {
    sum += static_cast<double>(v);
    while (next < 3 && sum >= 0.25 * (next + 1) * total) *targets[next++] = static_cast<double>(v);
  }
  return out;
}

}  // namespace mirage
