#include "client/freeze/eyes.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180;
constexpr double kRingDistances[] = {1, 0.6};  // of the home view's
constexpr double kHighestRing = 75 * kDegree;
constexpr double kPitches[] = {0, -40 * kDegree, 40 * kDegree};
constexpr int kYaws = 4;

std::vector<EyePart> rings(const FreezeOptions& options, const HomeView& home) {
  const Pose start = home_pose(home, freeze_camera(options));
  const glm::dvec3 arm = start.eye - home.target;
  const double distance = std::max(glm::length(arm), 1e-6);
  const double first_azimuth = std::atan2(arm.x, arm.z);
  const double first_elevation = std::asin(std::clamp(arm.y / distance, -1.0, 1.0));
  const double step = 2 * kPi / options.eyes;
  std::vector<double> elevations = {first_elevation};  // the home view is one of the eyes
  for (int i = 1; first_elevation + i * step <= kHighestRing; ++i)
    elevations.push_back(first_elevation + i * step);
  for (int i = 1; first_elevation - i * step >= -kHighestRing; ++i)
    elevations.push_back(first_elevation - i * step);
  std::vector<EyePart> out;
  for (const double share : kRingDistances) {
    for (const double elevation : elevations) {
      const int count =
          std::max(4, static_cast<int>(std::ceil(options.eyes * std::cos(elevation))));
      EyePart& part = out.emplace_back();
      for (int i = 0; i < count; ++i) {
        const double azimuth = first_azimuth + 2 * kPi * i / count;
        const glm::dvec3 to(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                            std::cos(elevation) * std::cos(azimuth));
        part.push_back(look_at(home.target + share * distance * to, home.target));
      }
    }
  }
  return out;
}

EyePart all_around(const glm::dvec3& eye) {
  EyePart out;
  for (const double pitch : kPitches) {
    for (int i = 0; i < kYaws; ++i) {
      const double yaw = 2 * kPi * i / kYaws;
      const glm::dvec3 to(std::sin(yaw) * std::cos(pitch), std::sin(pitch),
                          -std::cos(yaw) * std::cos(pitch));
      out.push_back(look_at(eye, eye + to));
    }
  }
  return out;
}

std::vector<EyePart> grid(const FreezeOptions& options, const EyeBox& box) {
  const glm::dvec3 extent = box.high - box.low;
  const double longest = std::max({extent.x, extent.y, extent.z});
  const double step = longest / std::max(1, options.eyes / 3 - 1);
  glm::ivec3 count(1);
  for (int i = 0; i < 3; ++i) {
    if (extent[i] > 0) count[i] = 1 + static_cast<int>(std::ceil(extent[i] / step - 1e-9));
  }
  std::vector<EyePart> out;
  for (int x = 0; x < count.x; ++x) {
    for (int y = 0; y < count.y; ++y) {
      for (int z = 0; z < count.z; ++z) {
        const auto at = [&](int axis, int i) {
          if (count[axis] == 1) return 0.5 * (box.low[axis] + box.high[axis]);
          return box.low[axis] + extent[axis] * i / (count[axis] - 1);
        };
        out.push_back(all_around({at(0, x), at(1, y), at(2, z)}));
      }
    }
  }
  return out;
}

}  // namespace

Camera freeze_camera(const FreezeOptions& options) {
  Camera camera;
  camera.width = options.width;
  camera.height = options.height;
  camera.fov_y = options.fov_degrees * kDegree;
  return camera;
}

std::vector<EyePart> eye_parts(const FreezeOptions& options, const HomeView& home) {
  return options.box ? grid(options, *options.box) : rings(options, home);
}

EyePart between(const EyePart& part) {
  EyePart out;
  for (std::size_t i = 0; i + 1 < part.size(); ++i) {
    const Pose &a = part[i], &b = part[i + 1];
    out.push_back(
        {0.5 * (a.eye + b.eye), glm::normalize(glm::slerp(a.rotation, b.rotation, 0.5f))});
  }
  return out;
}

}  // namespace mirage
