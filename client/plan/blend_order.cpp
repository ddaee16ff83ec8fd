#include "client/plan/blend_order.h"

#include <algorithm>
#include <cmath>

#include "client/hold/tile_cache.h"
#include "protocol/base/order.h"
#include "protocol/model/need_mask.h"

namespace mirage {

double blend_distance(const DrawnImpostor& drawn, const SceneView& scene, const glm::dvec3& eye) {
  const InstanceView& view = scene.instances[drawn.instance];
  const double distance = glm::length(view.center - eye);
  const bool seen_through = drawn.tile && (scene.objects[view.object].needs & kNeedBlend);
  if (!seen_through) return distance + view.radius;
  const TileRecord& tile = *drawn.tile;
  const double before = tile.capture.distance - double{tile.measure.depth_min};
  return distance - before * double{view.world_from_object.scale};
}

void sort_for_blending(std::vector<DrawnImpostor>& impostors, const SceneView& scene,
                       const glm::dvec3& eye) {
  const bool through =
      std::any_of(impostors.begin(), impostors.end(), [&](const DrawnImpostor& drawn) {
        return scene.objects[scene.instances[drawn.instance].object].needs & kNeedBlend;
      });
  if (!through) return;  // they already are in the order of their far sides
  std::vector<double> nearness(impostors.size());
  for (std::size_t i = impostors.size(); i-- > 0;) {
    const bool fades =
        i + 1 < impostors.size() && impostors[i].instance == impostors[i + 1].instance;
    nearness[i] = fades ? nearness[i + 1] : -blend_distance(impostors[i], scene, eye);
  }
  std::vector<DrawnImpostor> sorted;
  sorted.reserve(impostors.size());
  for (const std::size_t i : ascending(nearness)) sorted.push_back(std::move(impostors[i]));
  impostors = std::move(sorted);
}

}  // namespace mirage
