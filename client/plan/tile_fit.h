#pragma once
// How well resident tiles serve a view, and which of them with which method serves it best.

#include <limits>

#include "client/frame/method_choice.h"

namespace mirage {

struct ObjectDescription;
struct TileGroup;
struct ViewGeometry;

/// A tile drawn with a method, seen from a view.
struct TileFit {
  TileRecordPtr tile;
  DrawMethod method = DrawMethod::kQuad;
  /// Position, texel footprint and motion; +inf when it cannot be trusted.
  double bound_px = std::numeric_limits<double>::infinity();
  double hole_px = 0;   ///< widest disocclusion; flat proxies have none, their bound covers it
  double size_px = 0;   ///< projected radius of the object
  double texel_px = 0;  ///< size of a texel on the screen

  /// The larger of what is wrong, disocclusions by their own tolerance at tau. Same unit as tau.
  double error_px(double tau_px) const;
  /// Drawn within tau.
  bool meets(double tau_px) const;
  /// A texel covers hardly more than a pixel, or than tau.
  bool sharp(double tau_px) const;
  /// Meets tau and is sharp, or as fine as any: nothing better needs to be asked for.
  bool settled(double tau_px) const;
};

/// Best of the group's tiles for the methods of flat proxies, or for stored depth. `tile` is null
/// when the group is empty.
TileFit best_flat(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                  double tau_px);
TileFit best_deep(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                  double tau_px);
/// Best with one method, or of all methods when the choice is automatic.
TileFit best_fit(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                 const MethodChoice& choice, double tau_px);
/// What showing `fit` costs, in px: its error or blur, at most the object's size (`size_px` its
/// projected radius), which is also what no tile costs.
double displayed_error_px(const TileFit& fit, double size_px, double tau_px);
/// One tile with one method.
TileFit fit_of(const TileRecordPtr& tile, DrawMethod method, const ObjectDescription& object,
               const ViewGeometry& view);

}  // namespace mirage
