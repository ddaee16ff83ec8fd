#include "client/plan/eight_views.h"

#include <algorithm>
#include <cmath>

#include "client/hold/tile_cache.h"
#include "client/price/ask_gain.h"
#include "protocol/base/limits.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

constexpr double kEighth = 0.78539816339744831;  // an eighth of a turn
// Such views are baked nearly orthographic, so that they serve any distance.
constexpr double kBakedRadii = 64;
constexpr double kViewTexelsPerPixel = 1.5;
constexpr double kFineEnough = 0.7;  // of the wanted edge: a class and a half less will do
constexpr double kSameDirection = 0.9999;

glm::dvec3 axis_of(const TileRecord& tile) { return -tile.capture.basis.forward; }

}  // namespace

TileFit nearest_view(const TileGroup& group, const ObjectDescription& object,
                     const ViewGeometry& view) {
  TileRecordPtr best;
  double best_cos = -2;
  for (const TileRecordPtr& tile : group.tiles) {
    const double cos_angle = glm::dot(axis_of(*tile), view.eye) / glm::length(view.eye);
    const bool as_near = best && std::abs(cos_angle - best_cos) < 1e-6;
    const bool finer =
        as_near && (tile->capture.edge > best->capture.edge ||
                    (tile->capture.edge == best->capture.edge && tile->serial > best->serial));
    if (best && !finer && (as_near || cos_angle < best_cos)) continue;
    best = tile;
    best_cos = cos_angle;
  }
  return best ? fit_of(best, DrawMethod::kQuad, object, view) : TileFit{};
}

std::optional<TileNeed> eight_view_need(const TileGroup& group, const ViewGeometry& view,
                                        double radius_px) {
  const double azimuth = kEighth * std::round(std::atan2(view.eye.x, view.eye.z) / kEighth);
  const glm::dvec3 direction(std::sin(azimuth), 0, std::cos(azimuth));
  TileNeed need;
  need.cell = *view_cell_from_direction(direction, limits::kMaxViewLevel);
  need.distance = *distance_bucket_from_radii(kBakedRadii, 0);
  need.size_class = static_cast<std::uint8_t>(
      std::min(size_class_for(kViewTexelsPerPixel * 2 * radius_px * 0.95), kMaxAskedSizeClass));
  const double fine_enough = kFineEnough * tile_edge(need.size_class);
  const bool held = std::any_of(group.tiles.begin(), group.tiles.end(), [&](const auto& tile) {
    return glm::dot(axis_of(*tile), direction) > kSameDirection &&
           tile->capture.edge >= fine_enough;
  });
  if (held) return std::nullopt;
  if (group.tiles.empty()) need.size_class = coarse_class(need.size_class);
  // Any image beats none; of wrong images the largest on the screen matters most.
  need.error_px = (group.tiles.empty() ? 2 : 0.5) * std::min(radius_px, 1e4);
  need.life_s = kLongestLife;
  return need;
}

}  // namespace mirage
