#include "client/plan/tile_fit.h"

#include <algorithm>
#include <initializer_list>
#include <limits>

#include "client/hold/tile_cache.h"
#include "client/plan/eight_views.h"
#include "client/plan/tile_need.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A texel may cover this many pixels (or taus) before a sharper tile is worth asking for.
constexpr double kSharpTexel = 1.15;

// True if `a` is the better fit: a settled one before others, then the one with less error. A
// coarse first tile may have less error than a finer one. Inside the swap distance every bound is
// infinite; the newest tile is then the best guess.
bool better(const TileFit& a, const TileFit& b, double tau) {
  if (!b.tile) return true;
  const bool settled = a.settled(tau);
  if (settled != b.settled(tau)) return settled;
  const double ea = a.error_px(tau), eb = b.error_px(tau);
  return ea < eb || (ea == eb && a.tile->serial > b.tile->serial);
}

// Returns the cheapest method of a tile that meets tau, or else its best one.
TileFit cheapest(const TileRecordPtr& tile, std::initializer_list<DrawMethod> methods,
                 const ObjectDescription& object, const ViewGeometry& view, double tau) {
  TileFit best;
  for (const DrawMethod method : methods) {
    const TileFit fit = fit_of(tile, method, object, view);
    if (!best.tile || fit.error_px(tau) < best.error_px(tau)) best = fit;
    if (best.meets(tau)) break;
  }
  return best;
}

TileFit best_of(const TileGroup& group, std::initializer_list<DrawMethod> methods,
                const ObjectDescription& object, const ViewGeometry& view, double tau) {
  TileFit best;
  for (const TileRecordPtr& tile : group.tiles) {
    // Most tiles of a moving object show another pose; reject them before anything more expensive.
    if (best.tile && tile->motion_px(object, view) > best.bound_px) continue;
    const TileFit fit = cheapest(tile, methods, object, view, tau);
    if (better(fit, best, tau)) best = fit;
  }
  return best;
}

}  // namespace

double TileFit::error_px(double tau_px) const {
  return std::max(bound_px, hole_px / hole_tolerance(tau_px, size_px));
}

bool TileFit::meets(double tau_px) const { return tile && !is_stale(error_px(tau_px), tau_px); }

bool TileFit::sharp(double tau_px, double pixel_px) const {
  return tile && texel_px <= kSharpTexel * std::max(pixel_px, tau_px);
}

bool TileFit::settled(double tau_px, double pixel_px) const {
  const bool finest = tile && tile->capture.edge >= tile_edge(kMaxAskedSizeClass);
  return meets(tau_px) && (finest || sharp(tau_px, pixel_px));
}

double displayed_error_px(const TileFit& fit, double size_px, double tau_px) {
  const double error = fit.tile ? std::max(fit.error_px(tau_px), fit.texel_px - 1.0) : kInfinity;
  return std::isfinite(error) ? std::min(error, 2 * size_px) : 2 * std::min(size_px, 1e4);
}

TileFit fit_of(const TileRecordPtr& tile, DrawMethod method, const ObjectDescription& object,
               const ViewGeometry& view) {
  const CaptureGeometry& capture = tile->whole();
  TileFit fit;
  fit.tile = tile;
  fit.method = method;
  fit.bound_px = tile->bound_px(method, object, view);
  fit.size_px = radius_px(view);
  fit.texel_px = texel_size_px(view, capture, tile->capture.edge);
  if (method == DrawMethod::kDepth) {
    fit.hole_px = std::min(position_bound_px(view, capture, {tile->measure.depth_gap, view.radius}),
                           kInfinity);
  }
  return fit;
}

TileFit best_flat(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                  double tau_px) {
  return best_of(group, {DrawMethod::kQuad, DrawMethod::kHull}, object, view, tau_px);
}

TileFit best_deep(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                  double tau_px) {
  return best_of(group, {DrawMethod::kDepth}, object, view, tau_px);
}

TileFit best_fit(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                 const MethodChoice& choice, double tau_px) {
  if (choice.eight_views) return nearest_view(group, object, view);
  if (!choice.automatic) return best_of(group, {choice.method}, object, view, tau_px);
  TileFit flat = best_flat(group, object, view, tau_px);
  if (flat.meets(tau_px)) return flat;
  TileFit deep = best_deep(group, object, view, tau_px);
  return deep.tile && better(deep, flat, tau_px) ? deep : flat;
}

}  // namespace mirage
