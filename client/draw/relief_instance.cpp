#include "client/draw/relief_instance.h"

#include <algorithm>

#include "client/hold/tile_cache.h"

namespace mirage {
namespace {

constexpr double kCodes = 254;
// A tile that fades in lies on top of the one it replaces.
constexpr float kReliefFadeBias = 0.002f;

struct TileWindow {
  double left = 0, top = 0, right = 0, bottom = 0;  // tangents
  double texels = 0;                                // texels per tangent
};

TileWindow window_of(const TileRecord& tile) {
  const double per_texel = 2.0 * tile.capture.half_tangent / tile.capture.edge;
  TileWindow w;
  w.left = tile.crop.x * per_texel - tile.capture.half_tangent;
  w.top = tile.capture.half_tangent - tile.crop.y * per_texel;
  w.right = w.left + tile.crop.w * per_texel;
  w.bottom = w.top - tile.crop.h * per_texel;
  w.texels = 1.0 / per_texel;
  return w;
}

// Returns the unrounded code of a depth.
double code_of(const DepthCode& code, double z) {
  const double u =
      code.far_depth * (z - code.near_depth) / (z * (code.far_depth - code.near_depth));
  return std::clamp(u, 0.0, 1.0) * kCodes;
}

// Returns the least and the largest code of the content. They are widened by a step of rounding so
// that no ray starts on the content.
glm::dvec2 code_range(const TileRecord& tile) {
  return {std::max(code_of(tile.depth_code, tile.measure.depth_min) - 1.0, -1.0),
          std::min(code_of(tile.depth_code, tile.measure.depth_max) + 1.0, kCodes + 1.0)};
}

}  // namespace

ReliefInstance relief_instance(const DrawnImpostor& drawn, const Camera& camera,
                               const SceneView& scene) {
  const InstanceView& view = scene.instances[drawn.instance];
  const TileRecord& tile = *drawn.tile;
  const Capture& capture = tile.capture;
  const TileWindow w = window_of(tile);
  const glm::quat& q = view.world_from_object.rotation;
  ReliefInstance out{};
  out.rotation = {q.x, q.y, q.z, q.w};
  out.center_scale = {glm::vec3(view.center - camera.pose.eye), view.world_from_object.scale};
  out.right_distance = glm::vec4(glm::vec3(capture.basis.right), capture.distance);
  out.up_texels = glm::vec4(glm::vec3(capture.basis.up), w.texels);
  out.window = {w.left, w.top, w.right, w.bottom};
  out.place = {tile.slot.x + 1, tile.slot.y + 1, tile.slot.layer, drawn.fade};
  const glm::dvec2 range = code_range(tile);
  out.range = {tile.depth_code.near_depth, tile.depth_code.far_depth, range.x, range.y};
  const double slack = capture.depth_slack(tile.measure.depth_max);
  out.slack = {drawn.fade < 1 ? kReliefFadeBias : 0.0f, slack, 0, 0};
  if (tile.layered()) {
    const auto from = [&](const AtlasSlot& s) {
      return glm::vec4(s.x - tile.slot.x, s.y - tile.slot.y, s.layer, 0);
    };
    out.front = from(tile.front_slot);
    out.behind = from(tile.behind_slot);
  }
  out.shadow = worn_shadow(drawn, q);
  return out;
}

}  // namespace mirage
