#include "client/core/relief_instance.h"

#include <algorithm>
#include <cmath>

#include "protocol/stable_math.h"

namespace mirage {
namespace {

constexpr double kCodes = 254;
// A tile fading in lies on top of the one it replaces.
constexpr float kFadeBias = 0.002f;

struct TileWindow {
  double left = 0, top = 0, right = 0, bottom = 0;  // tangents
  double texels = 0;                                // per tangent
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

// Code of a depth, unrounded.
double code_of(const DepthCode& code, double z) {
  const double u =
      code.far_depth * (z - code.near_depth) / (z * (code.far_depth - code.near_depth));
  return std::clamp(u, 0.0, 1.0) * kCodes;
}

// Least and largest code of the content, a step of rounding apart so that no ray starts on it.
glm::dvec2 code_range(const TileRecord& tile) {
  return {std::max(code_of(tile.depth_code, tile.measure.depth_min) - 1.0, -1.0),
          std::min(code_of(tile.depth_code, tile.measure.depth_max) + 1.0, kCodes + 1.0)};
}

// Tile space of a point p relative to the centre, times its depth (relief.vert).
struct TileMap {
  glm::dvec4 x, y, z, origin;
  glm::dvec4 apply(const glm::dvec3& p) const { return x * p.x + y * p.y + z * p.z + origin; }
};

TileMap tile_map(const TileRecord& tile) {
  const Capture& c = tile.capture;
  const TileWindow w = window_of(tile);
  const glm::dvec2 first =
      glm::dvec2(tile.slot.x + 1, tile.slot.y + 1) - glm::dvec2(w.left, -w.top) * w.texels;
  const DepthCode& code = tile.depth_code;
  const double codes = kCodes * code.far_depth / (code.far_depth - code.near_depth);
  const auto column = [&](const glm::dvec3& axis) {
    const double ahead = glm::dot(axis, c.basis.forward);
    const double right = glm::dot(axis, c.basis.right), up = glm::dot(axis, c.basis.up);
    return glm::dvec4(first.x * ahead + right * w.texels, first.y * ahead - up * w.texels,
                      codes * ahead, ahead);
  };
  return {column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1}),
          glm::dvec4(first.x * c.distance, first.y * c.distance,
                     codes * (c.distance - code.near_depth), c.distance)};
}

// Near the capture direction a tile counts for all, half a turn away for nothing.
double merge_weight(const TileRecord& tile, const glm::dvec3& eye, double nearest) {
  const double angle = angle_between(tile.capture.eye(), eye);
  const double ratio = (nearest + 1e-4) / (angle + 1e-4);
  return ratio * ratio * ratio * ratio;
}

}  // namespace

ReliefInstance relief_instance(const DrawnImpostor& drawn, const Camera& camera,
                               const SceneView& scene, int row) {
  const InstanceView& view = scene.instances[drawn.instance];
  const ObjectDescription& object = scene.objects[view.object];
  const TileRecord& tile = *drawn.tile;
  const Capture& capture = tile.capture;
  const TileWindow w = window_of(tile);
  const glm::quat& q = view.world_from_object.rotation;
  ReliefInstance out;
  out.rotation = {q.x, q.y, q.z, q.w};
  out.center_scale = {glm::vec3(view.center - camera.pose.eye), view.world_from_object.scale};
  out.right_distance = glm::vec4(glm::vec3(capture.basis.right), capture.distance);
  out.up_texels = glm::vec4(glm::vec3(capture.basis.up), w.texels);
  out.window = {w.left, w.top, w.right, w.bottom};
  out.place = {tile.slot.x + 1, tile.slot.y + 1, tile.slot.layer, drawn.fade};
  const glm::dvec2 range = code_range(tile);
  out.range = {tile.depth_code.near_depth, tile.depth_code.far_depth, range.x, range.y};
  const double slack = tile.depth_code.quantum() + capture.texel_width(tile.measure.depth_max);
  out.slack = {drawn.fade < 1 ? kFadeBias : 0.0f, slack, 0, 0};
  out.box_min = glm::vec4(object.box_min - object.center, static_cast<float>(row));
  out.box_max = glm::vec4(object.box_max - object.center, 0);
  if (tile.layered()) {  // its shader has no use for the box
    const auto from = [&](const AtlasSlot& s) {
      return glm::vec4(s.x - tile.slot.x, s.y - tile.slot.y, s.layer, 0);
    };
    out.box_min = from(tile.front_slot);
    out.box_max = from(tile.behind_slot);
  }
  out.shadow = worn_shadow(drawn, q);
  return out;
}

void append_relief_row(const DrawnImpostor& drawn, const Camera& camera, const SceneView& scene,
                       std::vector<glm::vec4>& out) {
  const InstanceView& view = scene.instances[drawn.instance];
  const glm::dvec3 eye = view_geometry(camera, view, scene.objects[view.object]).eye;
  const std::array<const TileRecord*, kReliefTiles> tiles = {
      drawn.tile.get(), drawn.neighbours[0].get(), drawn.neighbours[1].get()};
  const double nearest = angle_between(drawn.tile->capture.eye(), eye);
  for (const TileRecord* tile : tiles) {
    if (!tile) {
      out.insert(out.end(), kReliefTexelsPerTile, glm::vec4(0));
      continue;
    }
    const TileMap map = tile_map(*tile);
    const glm::dvec2 range = code_range(*tile);
    const glm::dvec2 low(tile->slot.x + 1, tile->slot.y + 1);
    for (const glm::dvec4& column : {map.x, map.y, map.z, map.origin}) out.emplace_back(column);
    out.emplace_back(map.apply(eye));
    out.emplace_back(glm::dvec4(low, range.x, tile->slot.layer));
    out.emplace_back(glm::dvec4(low.x + tile->crop.w, low.y + tile->crop.h, range.y,
                                merge_weight(*tile, eye, nearest)));
    out.emplace_back(0.0f);
  }
}

}  // namespace mirage
