#pragma once

#include <limits>
#include <set>

#include "client/frame/resident.h"

namespace mirage {

/// Method choice: draw impostors with one method, or with the cheapest that meets tau.
struct MethodChoice {
  bool automatic = true;
  DrawMethod method = DrawMethod::kQuad;
  bool eight_views = false;  ///< draw the eight-view baseline (eight_views.h) with kQuad
};

/// Flat methods: those that `auto` chooses from, and all of them.
inline const std::set<DrawMethod> kAutoFlatMethods = {DrawMethod::kQuad, DrawMethod::kHull};
inline const std::set<DrawMethod> kFlatMethods = {DrawMethod::kQuad, DrawMethod::kCuboid,
                                                  DrawMethod::kHull, DrawMethod::kWarp};

/// Distance, in radii of the object, within which geometry is drawn where methods of drawing tiles
/// are compared. It applies unless an option says otherwise.
inline constexpr double kSwapRadii = 8;
inline constexpr double kAnyRadii = std::numeric_limits<double>::infinity();

}  // namespace mirage
