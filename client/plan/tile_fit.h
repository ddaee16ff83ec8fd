#pragma once
// Tile fit: how well resident tiles serve a view, and which tile serves it best, with which method.

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
  /// Bound of position, texel footprint and motion; +inf if it cannot be trusted.
  double bound_px = std::numeric_limits<double>::infinity();
  double hole_px = 0;   ///< widest disocclusion; 0 on flat proxies, whose bound covers it
  double size_px = 0;   ///< projected radius of the object
  double texel_px = 0;  ///< size of a texel on the screen

  /// Returns the larger error, px like tau: the bound, or disocclusions by their own tolerance at
  /// tau.
  double error_px(double tau_px) const;
  /// True if the error is within tau.
  bool meets(double tau_px) const;
  /// True if a texel covers hardly more than a drawn pixel of `pixel_px`, or than tau.
  bool sharp(double tau_px, double pixel_px = 1) const;
  /// True if it meets tau and is sharp, or as fine as any: nothing better needs to be asked for.
  bool settled(double tau_px, double pixel_px = 1) const;
};

/// Return the best of the group's tiles with flat methods, or with stored depth. `tile` is null if
/// the group is empty.
TileFit best_flat(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                  double tau_px);
TileFit best_deep(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                  double tau_px);
/// Returns the best tile with the chosen method, or with any method if the choice is automatic.
TileFit best_fit(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                 const MethodChoice& choice, double tau_px);
/// Returns the error, px, of showing `fit`: its error or blur, at most the object's size. `size_px`
/// is the projected radius. Without a tile the error is the object's size.
double displayed_error_px(const TileFit& fit, double size_px, double tau_px);
/// Returns the fit of one tile drawn with one method.
TileFit fit_of(const TileRecordPtr& tile, DrawMethod method, const ObjectDescription& object,
               const ViewGeometry& view);

}  // namespace mirage
