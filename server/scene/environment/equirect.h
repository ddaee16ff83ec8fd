#pragma once
// Radiance from all directions on a rectangle: longitude across, latitude down.

#include <glm/glm.hpp>
#include <vector>

namespace mirage {

struct Equirect {
  int width = 0, height = 0;
  std::vector<glm::vec3> texels;  ///< linear radiance >= 0, finite; rows from +y down

  const glm::vec3& at(int x, int y) const {
    return texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

/// Returns the unit direction of a texel's centre: u = atan2(z, x) / 2 pi + 1/2, as in three.js.
glm::dvec3 equirect_direction(const Equirect& image, int x, int y);

}  // namespace mirage
