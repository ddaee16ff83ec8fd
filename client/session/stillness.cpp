#include "client/session/stillness.h"

#include "client/hold/shadow_cache.h"
#include "client/hold/tile_cache.h"
#include "client/scene/scene_view.h"
#include "protocol/impostor/lighting_state.h"

namespace mirage {
namespace {

std::vector<double> numbers(const PlannedFrame& frame) {
  const Camera& camera = frame.camera;
  const SceneView& scene = *frame.scene;
  const DrawList& list = frame.list;
  const glm::dvec3& eye = camera.pose.eye;
  const glm::quat& q = camera.pose.rotation;
  std::vector<double> out = {eye.x,
                             eye.y,
                             eye.z,
                             double{q.w},
                             double{q.x},
                             double{q.y},
                             double{q.z},
                             camera.fov_y,
                             camera.near_m,
                             camera.far_m,
                             static_cast<double>(camera.width),
                             static_cast<double>(camera.height),
                             camera.shift_px.x,
                             camera.shift_px.y,
                             camera.pixel_aspect};
  const auto put = [&](auto value) { out.push_back(static_cast<double>(value)); };
  put(list.impostors.size());
  for (const DrawnImpostor& drawn : list.impostors) {
    put(drawn.instance);
    put(drawn.tile->serial);
    put(drawn.method);
    put(drawn.fade);
    put(drawn.shadow ? drawn.shadow->serial : 0);
  }
  put(list.placeholders.size());
  for (const DrawnPlaceholder& drawn : list.placeholders) put(drawn.instance);
  bool moves = false;
  const auto goes = [&](std::uint32_t instance) {
    return scene.objects[scene.instances[instance].object].track.moves();
  };
  for (const DrawnImpostor& drawn : list.impostors) moves = moves || goes(drawn.instance);
  for (const DrawnPlaceholder& drawn : list.placeholders) moves = moves || goes(drawn.instance);
  for (const DrawnMesh& drawn : list.meshes) {
    put(drawn.instance);
    put(drawn.lod);
    put(drawn.fade);
    moves = moves || scene.objects[scene.instances[drawn.instance].object].moves();
  }
  put(moves ? list.time_s : 0.0);
  return out;
}

}  // namespace

bool Stillness::unchanged(const PlannedFrame& frame) {
  std::vector<double> now = numbers(frame);
  const CasterListPtr& casters = frame.list.casters;
  const bool same =
      known_ && now == drawn_ && casters == casters_ && same_lighting(frame.lighting, lighting_);
  known_ = true;
  drawn_ = std::move(now);
  casters_ = casters;
  lighting_ = frame.lighting;
  return same;
}

}  // namespace mirage
