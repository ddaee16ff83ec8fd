#include "client/draw/geometric_error.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "client/frame/planned_frame.h"
#include "client/frame/reference_frame.h"
#include "client/hold/tile_cache.h"
#include "client/scene/scene_view.h"

namespace mirage {
namespace {

// The reference frame's depth is a float of 24 bits of a hyperbolic buffer: its rounding grows
// towards the far end.
constexpr double kReferenceSlackPx = 1e-3;
constexpr double kHalfDiagonal = 0.7072;
constexpr double kSearchTexels = 24;  // to each side, for a point of a moving object

constexpr double kOneSurfaceCodes = 12;  // relief.glsl: 2 kWall

struct Shown {
  const DrawnImpostor* impostor = nullptr;
  std::vector<Plane> proxy;  // of a cuboid or hull
  bool mesh = false;
  std::uint64_t pixels = 0;
  double worst_px = 0;
};

// Returns the depth that the relief shader draws at the tile coordinates `texel`: interpolated
// between texel centres, at most half a code from the nearest one's (relief.glsl, refine).
double relief_depth(const TileRecord& tile, const glm::dvec2& texel, std::uint8_t nearest) {
  const glm::dvec2 at = texel - glm::dvec2(tile.crop.x + 0.5, tile.crop.y + 0.5);
  const double x0 = std::floor(at.x), y0 = std::floor(at.y);
  if (x0 < 0 || y0 < 0 || x0 + 1 >= tile.crop.w || y0 + 1 >= tile.crop.h) {
    return tile.depth_code.decode(nearest);
  }
  const std::uint8_t* c =
      &tile.depth[static_cast<std::size_t>(y0) * tile.crop.w + static_cast<std::size_t>(x0)];
  const double c00 = c[0], c10 = c[1], c01 = c[tile.crop.w], c11 = c[tile.crop.w + 1];
  const double low = std::min({c00, c10, c01, c11}), high = std::max({c00, c10, c01, c11});
  double code = nearest;
  if (low > 0 && high - low <= kOneSurfaceCodes) {
    const double fx = at.x - x0, fy = at.y - y0;
    code = (c00 * (1 - fx) + c10 * fx) * (1 - fy) + (c01 * (1 - fx) + c11 * fx) * fy;
    code = std::clamp(code, nearest - 0.5, nearest + 0.5);
  }
  const DepthCode& d = tile.depth_code;
  const double u = (code - 1) / 254;
  return d.near_depth * d.far_depth / (d.far_depth - u * (d.far_depth - d.near_depth));
}

std::vector<Plane> proxy_of(const DrawnImpostor& drawn, const ObjectDescription& object) {
  if (drawn.method == DrawMethod::kCuboid) return box_planes(object.box_min, object.box_max);
  return drawn.method == DrawMethod::kHull ? object.hull.planes() : std::vector<Plane>{};
}

// Returns the capture depth at which the tile's method draws the ray through p; 0 if it draws
// nothing.
double drawn_capture_depth(const Shown& shown, const ObjectDescription& object, const glm::dvec3& p,
                           double stored) {
  const DrawnImpostor& drawn = *shown.impostor;
  const TileRecord& tile = *drawn.tile;
  const Capture& capture = tile.capture;
  const glm::dvec3 eye = capture.eye();
  const double z = capture.depth(p);
  const glm::dvec3 direction = (p - eye) / z;  // of length 1 along the capture axis
  const glm::dvec3 origin = glm::dvec3(object.center) + eye;
  switch (drawn.method) {
    case DrawMethod::kCuboid:
    case DrawMethod::kHull:
      return ray_entry(shown.proxy, origin, direction);
    case DrawMethod::kDepth:
      return stored;
    case DrawMethod::kWarp: {
      // The place within the tile's range depends on the eye, so the worse end is taken.
      const double low = tile.measure.depth_min, high = tile.measure.depth_max;
      return 1 / low - 1 / z > 1 / z - 1 / high ? low : high;
    }
    case DrawMethod::kQuad:
    case DrawMethod::kMesh:
      break;
  }
  return tile.measure.plane_depth;
}

struct PixelError {
  bool seen = false;  ///< true if the tile saw this point
  double error_px = 0;
  double slack_px = 0;  ///< uncertainty of the measurement
};

/// A point of the reference frame in the coordinates of the tile that shows it.
struct TilePoint {
  TilePoint(const DrawnImpostor& drawn, const InstanceView& view, const Camera& camera,
            const glm::dvec3& relative)
      : scale(view.world_from_object.scale),
        rotation(view.world_from_object.rotation),
        center(view.center - camera.pose.eye),
        p(glm::conjugate(rotation) * (relative - center) / scale),
        z(drawn.tile->capture.depth(p)) {}
  /// Returns a point relative to the eye, on world axes.
  glm::dvec3 relative_of(const glm::dvec3& q) const { return center + rotation * (q * scale); }

  double scale;
  glm::dquat rotation;
  glm::dvec3 center;  ///< the object's centre, relative to the eye, world axes
  glm::dvec3 p;       ///< the point relative to the object's centre, object units
  double z;           ///< capture depth of the point
};

// True if the dz of the tile's method says nothing of a point at capture depth z: that of a flat
// proxy covers the depth range of what the tile saw, that of marched depth covers what a texel may
// hold. A point that moved by up to `travel` since the tile's pose lay within `travel` of z then.
bool beyond_depth_range(const DrawnImpostor& drawn, double z, double travel) {
  const TileMeasure& measure = drawn.tile->measure;
  return drawn.method != DrawMethod::kDepth &&
         (z < measure.depth_min - travel || z > measure.depth_max + travel);
}

// Measures a point of a moving object. It is unknown where that point was at the tile's pose, only
// that it was within the distance that the clip can move it. Of all surface points that the tile
// saw within that distance, this takes the one drawn nearest. The true error is no less, so an
// error beyond the bound here really exceeds it.
PixelError moving_error(const Shown& shown, const InstanceView& view,
                        const ObjectDescription& object, const Camera& camera,
                        const glm::dvec3& relative, double time_s) {
  const DrawnImpostor& drawn = *shown.impostor;
  const TileRecord& tile = *drawn.tile;
  const Capture& capture = tile.capture;
  const TilePoint at(drawn, view, camera, relative);
  const double z = at.z;
  if (!(z > 0)) return {};
  const double texel_width = capture.texel_width(z);
  const double clip_s = object.motion.clip_s;
  const double now = wrap_clip(time_s + view.clip_offset_s, clip_s);
  const double travel = object.motion.travel(phase_time(tile.phase, clip_s), now);
  if (beyond_depth_range(drawn, z, travel)) return {};
  const double match = travel + tile.depth_code.quantum() + 2.0 * texel_width;
  const glm::dvec2 middle = capture.texel_from_point(at.p) - glm::dvec2(tile.crop.x, tile.crop.y);
  // Half a texel's diagonal is added because the point may lie anywhere in the texel.
  const double texels = travel / capture.texel_width(std::max(z - travel, 0.5 * z)) + kHalfDiagonal;
  const int stride = std::max(1, static_cast<int>(std::ceil(texels / kSearchTexels)));
  const auto low = [&](double v) { return std::max(0, static_cast<int>(v - texels)); };
  const auto high = [&](double v, std::uint32_t n) {
    return std::min(static_cast<int>(n) - 1, static_cast<int>(v + texels));
  };
  PixelError best;
  for (int y = low(middle.y); y <= high(middle.y, tile.crop.h); y += stride) {
    for (int x = low(middle.x); x <= high(middle.x, tile.crop.w); x += stride) {
      const std::uint8_t code =
          tile.depth[static_cast<std::size_t>(y) * tile.crop.w + static_cast<std::size_t>(x)];
      if (code == 0) continue;
      const double stored = tile.depth_code.decode(code);
      const glm::dvec2 offset(x + 0.5, y + 0.5);
      if (std::abs(stored - z) > match || glm::length(offset - middle) > texels) continue;
      const glm::dvec3 s =
          capture.point_from_texel(offset + glm::dvec2(tile.crop.x, tile.crop.y), stored);
      const double zq = drawn_capture_depth(shown, object, s, stored);
      if (!(zq > 0)) continue;
      const glm::dvec3 q = capture.eye() + (s - capture.eye()) * (zq / stored);
      const double error = point_error_px(camera.focal_px(), relative, at.relative_of(q),
                                          camera.forward(), camera.right(), camera.up());
      if (best.seen && error >= best.error_px) continue;
      best = {true, error, 0};
    }
  }
  // The best point may lie between the texels that were looked at, in any direction from them. Away
  // from the middle of the picture, perspective lengthens a step by up to 1 / cos of its angle.
  const double depth = glm::dot(relative, camera.forward());
  const double lengthened = glm::length(relative) / depth;
  best.slack_px =
      kHalfDiagonal * stride * texel_width * at.scale * camera.focal_px() / depth * lengthened;
  return best;
}

PixelError pixel_error(const Shown& shown, const InstanceView& view,
                       const ObjectDescription& object, const Camera& camera,
                       const glm::dvec3& relative) {
  const DrawnImpostor& drawn = *shown.impostor;
  const TileRecord& tile = *drawn.tile;
  const Capture& capture = tile.capture;
  const TilePoint at(drawn, view, camera, relative);
  const glm::dvec3& p = at.p;
  const double z = at.z;
  const glm::dvec2 texel = capture.texel_from_point(p);
  const double x = std::floor(texel.x) - tile.crop.x, y = std::floor(texel.y) - tile.crop.y;
  if (!(z > 0) || x < 0 || y < 0 || x >= tile.crop.w || y >= tile.crop.h) return {};
  const std::uint8_t code =
      tile.depth[static_cast<std::size_t>(y) * tile.crop.w + static_cast<std::size_t>(x)];
  if (code == 0) return {};
  const double stored = tile.depth_code.decode(code);
  // The tolerance that TileRecord::drawn_depth promises: half a step, and two texels of slope.
  const double match = tile.depth_code.inverse_quantum() +
                       2.0 * capture.texel_width(1.0) / tile.measure.depth_min +
                       tile.measure.lod_error / (z * stored);
  if (std::abs(1.0 / z - 1.0 / stored) > match) return {};
  if (beyond_depth_range(drawn, z, 0)) return {};
  const double zq = drawn_capture_depth(shown, object, p, relief_depth(tile, texel, code));
  if (!(zq > 0)) return {};
  const glm::dvec3 q = capture.eye() + (p - capture.eye()) * (zq / z);
  return {true,
          point_error_px(camera.focal_px(), relative, at.relative_of(q), camera.forward(),
                         camera.right(), camera.up()),
          0};
}

using ShownMap = std::unordered_map<std::uint32_t, Shown>;  // by instance

// Returns the instances that stand for the one with this id: itself, its parts, or a group it is
// in.
std::vector<std::uint32_t> standing_for(std::uint32_t id, const SceneView& scene,
                                        const ShownMap& shown) {
  std::vector<std::uint32_t> out;
  const std::uint32_t known = scene.index_of(id);
  if (known == InstanceView::kNoParent) {
    const auto at = std::find_if(shown.begin(), shown.end(), [&](const auto& one) {
      const InstanceView& group = scene.instances[one.first];
      return id - group.first_leaf < group.leaves && id >= group.first_leaf;
    });
    if (at != shown.end()) out.push_back(at->first);
    return out;
  }
  for (const std::uint32_t part : scene.members(known)) {
    if (shown.count(part) != 0) out.push_back(part);
  }
  std::uint32_t instance = known;
  while (instance != InstanceView::kNoParent && shown.count(instance) == 0) {
    instance = scene.instances[instance].parent;
  }
  if (instance != InstanceView::kNoParent) out.push_back(instance);
  return out;
}

// Compares the point of one pixel, relative to the eye, with everything that stands for its
// instance. Pictures of neighbouring parts overlap, so several may show the point.
void compare(const std::vector<std::uint32_t>& standing, const glm::dvec3& relative,
             const Camera& camera, const SceneView& scene, double time_s, ShownMap& shown,
             GeometricError& out) {
  bool seen = false;
  for (const std::uint32_t instance : standing) {
    Shown& one = shown.at(instance);
    const DrawnImpostor& impostor = *one.impostor;
    const InstanceView& view = scene.instances[instance];
    const ObjectDescription& object = scene.objects[view.object];
    const PixelError error = object.motion.moving()
                                 ? moving_error(one, view, object, camera, relative, time_s)
                                 : pixel_error(one, view, object, camera, relative);
    if (!error.seen) continue;
    seen = true;
    ++out.compared;
    out.errors_px.push_back(static_cast<float>(error.error_px));
    ++one.pixels;
    one.worst_px = std::max(one.worst_px, error.error_px);
    if (error.error_px > impostor.bound_px + kReferenceSlackPx + error.slack_px) {
      ++out.violations;
      out.worst_excess_px = std::max(out.worst_excess_px, error.error_px - impostor.bound_px);
    }
  }
  out.disoccluded += !seen;
}

}  // namespace

void add_geometric_error(const ReferenceFrame& reference, double offset_px,
                         const PlannedFrame& frame, GeometricError& out) {
  const Camera& camera = frame.camera;
  const SceneView& scene = *frame.scene;
  const DrawList& drawn = frame.list;
  ShownMap shown;
  for (const DrawnImpostor& impostor : drawn.impostors) {
    Shown& one = shown[impostor.instance];
    one.impostor = &impostor;
    one.proxy = proxy_of(impostor, scene.objects[scene.instances[impostor.instance].object]);
  }
  for (const DrawnMesh& mesh : drawn.meshes) shown[mesh.instance].mesh = true;
  const double f = camera.focal_px();
  const glm::dvec3 right = camera.right(), up = camera.up(), forward = camera.forward();
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> standing_of;
  for (std::uint32_t y = 0; y < reference.height; ++y) {
    for (std::uint32_t x = 0; x < reference.width; ++x) {
      const std::size_t i = std::size_t{y} * reference.width + x;
      if (reference.ids[i] == 0 || reference.ids[i] > scene.all_instances) continue;
      ++out.object_pixels;
      const std::uint32_t id = reference.ids[i] - 1;
      auto at = standing_of.find(id);
      if (at == standing_of.end()) {
        at = standing_of.emplace(id, standing_for(id, scene, shown)).first;
      }
      const std::vector<std::uint32_t>& standing = at->second;
      if (standing.empty()) {
        const bool viewed = drawn.view && drawn.view->shows(id);  // the view tile claims no bound
        ++(viewed ? out.viewed : out.holes);
        continue;
      }
      const bool mesh = std::any_of(standing.begin(), standing.end(),
                                    [&](std::uint32_t one) { return shown.at(one).mesh; });
      if (mesh) continue;
      const double z = reference.depth[i];
      const double px = x + offset_px - 0.5 * camera.width;
      // Rows count from the top here; the reference sampled them from the bottom.
      const double py = 0.5 * camera.height - (y + 1.0 - offset_px);
      const glm::dvec3 relative = (right * (px / f) + up * (py / f) + forward) * z;
      compare(standing, relative, camera, scene, drawn.time_s, shown, out);
    }
  }
  for (const auto& [instance, one] : shown) {
    if (one.pixels < kRatioPixels || one.worst_px < 0.01) continue;
    if (!std::isfinite(one.impostor->bound_px)) continue;
    out.ratios.push_back(static_cast<float>(one.impostor->bound_px / one.worst_px));
  }
}

}  // namespace mirage
