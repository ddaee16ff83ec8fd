#include "client/plan/mesh_wants.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/hold/asset_need.h"
#include "client/hold/mesh_cache.h"
#include "client/plan/selector_input.h"
#include "client/price/ask_gain.h"
#include "client/price/view_fit.h"
#include "client/scene/scene_view.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {

std::vector<MeshWant> mesh_wants(const SelectorInput& in, const MeshWants& wants) {
  const SceneView& scene = *in.scene;
  const Camera& camera = in.predicted;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Seen {
    MeshWant want;
    double size_px = 0;
    double view_px = 0;  ///< largest error of the view tile; infinite: not shown
  };
  std::map<std::uint32_t, Seen> by_object;
  for (const std::uint32_t i : wants.instances) {
    const std::uint32_t object = scene.instances[i].object;
    Seen& seen = by_object[object];
    seen.want.object = object;
    const double density = px_per_unit(scene, camera, i);
    seen.want.px_per_unit = std::max(seen.want.px_per_unit, density);
    const double most = std::hypot(camera.width, camera.height);
    seen.size_px = std::max(seen.size_px, std::min(density * scene.objects[object].radius, most));
    const std::optional<double> in_view =
        in.view ? in.view->error_px(scene.instances[i], scene.objects[object], camera, in.time_s)
                : std::nullopt;
    seen.view_px = std::max(seen.view_px, in_view.value_or(kInfinity));
    seen.want.surrounds = seen.want.surrounds || scene.objects[object].surrounds;
  }
  std::vector<MeshWant> out;
  for (auto& [object, seen] : by_object) {
    const auto gain = wants.gain.find(object);
    if (gain != wants.gain.end()) seen.want.gain = gain->second;
    seen.want.area_px = disc_px(camera, seen.size_px);
    seen.want.life_s = kLongestLife;
    seen.want.unseen = seen.view_px > kFirstImagePx * in.mesh_tau_px;
    out.push_back(seen.want);
  }
  return out;
}

}  // namespace mirage
