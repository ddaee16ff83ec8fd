#include "client/core/neighbours.h"

#include <algorithm>

#include "protocol/stable_math.h"

namespace mirage {
namespace {

constexpr double kFarthest = 0.61;  // radians: farther tiles see too little of what is in view
constexpr double kSameSide = 0.5;   // cosine between the directions in which tiles lie off the eye
constexpr double kOnTheEye = 1e-3;  // radians: nothing is hidden from such a tile

struct Near {
  const TileRecordPtr* tile = nullptr;
  double angle = 0;
  glm::dvec3 off{0};  // unit, from the eye's direction towards the capture's
};

}  // namespace

std::array<TileRecordPtr, 3> neighbours_for(const TileGroup& group, const ViewGeometry& view) {
  const glm::dvec3 eye = safe_normalize(view.eye);
  std::vector<Near> all;
  for (const TileRecordPtr& tile : group.tiles) {
    const glm::dvec3 axis = -tile->capture.basis.forward;
    all.push_back({&tile, angle_between(axis, eye), safe_normalize(axis - eye)});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Near& a, const Near& b) { return a.angle < b.angle; });
  std::array<TileRecordPtr, 3> out{};
  std::array<glm::dvec3, 3> off{};
  std::size_t count = 0;
  for (const Near& near : all) {
    if (count == out.size()) break;
    if (count > 0 && (near.angle > kFarthest || all[0].angle < kOnTheEye)) break;
    const bool new_side =
        std::none_of(off.begin(), off.begin() + std::ptrdiff_t(count),
                     [&](const glm::dvec3& o) { return glm::dot(o, near.off) > kSameSide; });
    if (count > 0 && !new_side) continue;
    off[count] = near.off;
    out[count++] = *near.tile;
  }
  return out;
}

}  // namespace mirage
