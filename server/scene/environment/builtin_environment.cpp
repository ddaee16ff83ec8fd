#include "server/scene/environment/builtin_environment.h"

#include <cmath>
#include <functional>

namespace mirage {
namespace {

constexpr int kSkyWidth = 512, kSkyHeight = 256;
/// Exposure that brings the brightest irradiance over pi of the studio to 0.95 (a test checks it).
constexpr double kStudioExposure = 0.90;

double smooth(double low, double high, double v) {
  const double t = glm::clamp((v - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// A lamp behind a rectangular diffuser: 1 within `half` (tangents of the angles from its middle),
// fading over `edge`. Its middle must not be straight above or below.
double soft_box(const glm::dvec3& d, const glm::dvec3& middle, const glm::dvec2& half,
                double edge) {
  const glm::dvec3 forward = glm::normalize(middle);
  const double along = glm::dot(d, forward);
  if (along <= 0.05) return 0;
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
  const glm::dvec3 up = glm::cross(right, forward);
  const double x = std::abs(glm::dot(d, right)) / along, y = std::abs(glm::dot(d, up)) / along;
  return (1 - smooth(half.x - edge, half.x + edge, x)) *
         (1 - smooth(half.y - edge, half.y + edge, y));
}

glm::dvec3 studio(const glm::dvec3& d) {
  const double walls = 0.55 + 0.15 * smooth(-0.5, 0.6, d.y);
  const double lamps = 1.8 * soft_box(d, {0.75, 0.75, 0.6}, {0.45, 0.35}, 0.06) +
                       1.2 * soft_box(d, {-0.9, 0.35, 0.55}, {0.35, 0.6}, 0.06) +
                       1.4 * soft_box(d, {-0.35, 0.5, -1}, {0.7, 0.2}, 0.05);
  return glm::dvec3(kStudioExposure * (walls + lamps));
}

glm::dvec3 sky(const glm::dvec3& d) {
  const glm::dvec3 zenith(0.16, 0.30, 0.62), horizon(0.62, 0.70, 0.78), ground(0.20, 0.18, 0.15);
  if (d.y < 0) return glm::mix(horizon, ground, smooth(0, 0.12, -d.y));
  const double toward = glm::dot(d, glm::normalize(glm::dvec3(0.55, 0.6, 0.4)));
  const double angle = std::acos(glm::clamp(toward, -1.0, 1.0));
  const double disc = 1 - smooth(0.04, 0.055, angle), glow = std::exp(-6 * angle);
  return glm::mix(horizon, zenith, std::sqrt(d.y)) +
         glm::dvec3(1, 0.93, 0.8) * (170 * disc + 0.8 * glow);
}

Equirect drawn(const std::function<glm::dvec3(const glm::dvec3&)>& radiance) {
  Equirect out{kSkyWidth, kSkyHeight, {}};
  for (int y = 0; y < kSkyHeight; ++y) {
    for (int x = 0; x < kSkyWidth; ++x) {
      out.texels.emplace_back(radiance(equirect_direction(out, x, y)));
    }
  }
  return out;
}

}  // namespace

std::optional<Equirect> builtin_environment(const std::string& name) {
  if (name == "studio") return drawn(studio);
  if (name == "sky") return drawn(sky);
  return std::nullopt;
}

}  // namespace mirage
