#include "server/scene/environment/probe_filter.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace mirage {
namespace {

constexpr double kPi = glm::pi<double>();
// Samples of each level's lobe. A sample reads an area as wide as its share of the lobe, so the
// sharp lobes of the largest maps need few.
constexpr std::array<std::uint32_t, kProbeLevels.size()> kSamples = {16, 32, 64, 128, 128, 128};

// The image and its halvings, with rows weighted by their solid angle.
class Pyramid {
 public:
  explicit Pyramid(const Equirect& image) : levels_{image} {
    while (levels_.back().width > 1 || levels_.back().height > 1) {
      levels_.push_back(halved(levels_.back()));
    }
  }

  /// Returns the mean radiance around a unit direction, over about `solid_angle` steradian.
  glm::vec3 radiance(const glm::dvec3& d, double solid_angle) const {
    const Equirect& whole = levels_.front();
    const double texel = 4 * kPi / (double(whole.width) * whole.height);
    const double last = static_cast<double>(levels_.size() - 1);
    const double level = std::clamp(0.5 * std::log2(solid_angle / texel), 0.0, last);
    const double u = std::atan2(d.z, d.x) / (2 * kPi) + 0.5;
    const double v = std::acos(std::clamp(d.y, -1.0, 1.0)) / kPi;
    const auto lower = static_cast<std::size_t>(level);
    const auto upper = std::min(lower + 1, levels_.size() - 1);
    return glm::mix(bilinear(levels_[lower], u, v), bilinear(levels_[upper], u, v),
                    static_cast<float>(level - static_cast<double>(lower)));
  }

 private:
  static Equirect halved(const Equirect& in) {
    Equirect out{std::max(1, in.width / 2), std::max(1, in.height / 2), {}};
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) {
        glm::vec3 sum(0);
        float weight = 0;
        for (int j = y * in.height / out.height; j < (y + 1) * in.height / out.height; ++j) {
          const auto w = static_cast<float>(std::sin(kPi * (j + 0.5) / in.height));
          for (int i = x * in.width / out.width; i < (x + 1) * in.width / out.width; ++i) {
            sum += w * in.at(i, j);
            weight += w;
          }
        }
        out.texels.push_back(sum / weight);
      }
    }
    return out;
  }

  static glm::vec3 bilinear(const Equirect& image, double u, double v) {
    const double x = u * image.width - 0.5, y = v * image.height - 0.5;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    const auto row = [&](int j) {
      j = std::clamp(j, 0, image.height - 1);
      const int left = ((x0 % image.width) + image.width) % image.width;
      return glm::mix(image.at(left, j), image.at((left + 1) % image.width, j), fx);
    };
    return glm::mix(row(y0), row(y0 + 1), fy);
  }

  std::vector<Equirect> levels_;
};

// A sample of the lobe about +z, seen along +z, and its weight.
struct Sample {
  glm::dvec3 direction;
  double weight = 0;       ///< cosine, normalised to a sum of 1
  double solid_angle = 0;  ///< its share of the sphere, sr
};

double radical_inverse(std::uint32_t i) {
  double out = 0, place = 0.5;
  for (; i > 0; i >>= 1, place *= 0.5) out += (i & 1u) * place;
  return out;
}

// Importance-sampled GGX halfway vectors (Karis 2013, "Real Shading in Unreal Engine 4"); each
// sample has the solid angle of its density (Krivanek and Colbert 2008).
std::vector<Sample> lobe(double roughness, std::uint32_t samples) {
  const double a2 = std::pow(roughness, 4);
  std::vector<Sample> out;
  double sum = 0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const double turn = 2 * kPi * (i + 0.5) / samples, share = radical_inverse(i);
    const double cosine2 = (1 - share) / (1 + (a2 - 1) * share);
    const double cosine = std::sqrt(cosine2), sine = std::sqrt(std::max(0.0, 1 - cosine2));
    const glm::dvec3 halfway(sine * std::cos(turn), sine * std::sin(turn), cosine);
    const glm::dvec3 d = 2 * cosine * halfway - glm::dvec3(0, 0, 1);
    if (d.z <= 0) continue;
    const double spread = cosine2 * (a2 - 1) + 1;
    const double density = a2 / (kPi * spread * spread) / 4;
    out.push_back({d, d.z, 1 / (samples * density)});
    sum += d.z;
  }
  for (Sample& s : out) s.weight /= sum;
  return out;
}

void filter_row(const Pyramid& from, const ProbeLevel& level, const std::vector<Sample>& samples,
                int y, std::vector<std::uint32_t>& texels) {
  const double inside = level.edge - 2;
  for (int x = 0; x < level.edge; ++x) {
    const glm::dvec3 n = probe_direction((x - 0.5) / inside, (y - 0.5) / inside);
    const glm::dvec3 beside = std::abs(n.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(beside, n)), up = glm::cross(n, right);
    glm::dvec3 sum(0);
    for (const Sample& s : samples) {
      const glm::dvec3 d = right * s.direction.x + up * s.direction.y + n * s.direction.z;
      sum += s.weight * glm::dvec3(from.radiance(d, s.solid_angle));
    }
    const auto at = static_cast<std::size_t>((level.y + y) * kProbeWidth + level.x + x);
    texels[at] = pack_shared_exponent(glm::vec3(sum));
  }
}

// Ramamoorthi and Hanrahan 2001, "An Efficient Representation for Irradiance Environment Maps": the
// bands of radiance are scaled by 1, 2/3 and 1/4, the effect of a cosine lobe over pi.
std::array<glm::vec3, kProbeTerms> irradiance_of(const Equirect& image) {
  // An image of few texels is sampled on a finer grid, because it is more than a sum of few
  // directions.
  const Equirect grid{std::max(image.width, 128), std::max(image.height, 64), {}};
  std::array<glm::dvec3, kProbeTerms> sum{};
  for (int y = 0; y < grid.height; ++y) {
    const double top = std::cos(kPi * y / grid.height);
    const double bottom = std::cos(kPi * (y + 1) / grid.height);
    const double area = (top - bottom) * 2 * kPi / grid.width;
    for (int x = 0; x < grid.width; ++x) {
      const glm::dvec3 d = equirect_direction(grid, x, y);
      const double terms[kProbeTerms] = {1,
                                         d.y,
                                         d.z,
                                         d.x,
                                         d.x * d.y,
                                         d.y * d.z,
                                         3 * d.z * d.z - 1,
                                         d.x * d.z,
                                         d.x * d.x - d.y * d.y};
      const glm::vec3& radiance =
          image.at(x * image.width / grid.width, y * image.height / grid.height);
      const glm::dvec3 light = glm::dvec3(radiance) * area;
      for (std::size_t i = 0; i < kProbeTerms; ++i) sum[i] += light * terms[i];
    }
  }
  constexpr double kBand0 = 0.282095, kBand1 = 0.488603, kBand2 = 1.092548, kAxis = 0.315392,
                   kDifference = 0.546274;
  const double scale[kProbeTerms] = {kBand0, kBand1, kBand1, kBand1,     kBand2,
                                     kBand2, kAxis,  kBand2, kDifference};
  std::array<glm::vec3, kProbeTerms> out;
  for (std::size_t i = 0; i < kProbeTerms; ++i) {
    const double cosine = i == 0 ? 1.0 : i < 4 ? 2.0 / 3 : 0.25;
    out[i] = glm::vec3(sum[i] * (scale[i] * scale[i] * cosine));
  }
  return out;
}

}  // namespace

glm::dvec3 equirect_direction(const Equirect& image, int x, int y) {
  const double longitude = (2.0 * (x + 0.5) / image.width - 1) * kPi;
  const double latitude = kPi * (y + 0.5) / image.height;
  const double around = std::sin(latitude);
  return {around * std::cos(longitude), std::cos(latitude), around * std::sin(longitude)};
}

LightProbe make_probe(const Equirect& image, const Workers& workers) {
  LightProbe out;
  out.texels.assign(kProbeTexels, 0);
  const Pyramid pyramid(image);
  struct Row {
    std::size_t level;
    int y;
  };
  std::vector<Row> rows;
  std::vector<std::vector<Sample>> lobes;
  for (std::size_t i = 0; i < kProbeLevels.size(); ++i) {
    lobes.push_back(lobe(probe_roughness(i), kSamples[i]));
    for (int y = 0; y < kProbeLevels[i].edge; ++y) rows.push_back({i, y});
  }
  workers.each(rows.size() + 1, [&](std::size_t i) {
    if (i == rows.size()) {
      out.irradiance = irradiance_of(image);
    } else {
      const Row& row = rows[i];
      filter_row(pyramid, kProbeLevels[row.level], lobes[row.level], row.y, out.texels);
    }
  });
  out.id = probe_id(out);
  return out;
}

}  // namespace mirage
