#pragma once

#include <limits>
#include <set>

#include "client/frame/resident.h"

namespace mirage {

/// How impostors are drawn: one method, or the cheapest that meets tau.
struct MethodChoice {
  bool automatic = true;
  DrawMethod method = DrawMethod::kQuad;
  bool eight_views = false;  ///< a baseline (eight_views.h); with kQuad
};

/// Flat methods: those that `auto` chooses among, and all there are.
inline const std::set<DrawMethod> kAutoFlatMethods = {DrawMethod::kQuad, DrawMethod::kHull};
inline const std::set<DrawMethod> kFlatMethods = {DrawMethod::kQuad, DrawMethod::kCuboid,
                                                  DrawMethod::kHull, DrawMethod::kWarp};

/// Where methods of drawing tiles are compared, geometry is drawn within this many radii unless
/// something else is said.
inline constexpr double kSwapRadii = 8;
inline constexpr double kAnyRadii = std::numeric_limits<double>::infinity();

}  // namespace mirage
