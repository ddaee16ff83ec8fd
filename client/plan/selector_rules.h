#pragma once
// What deciding what to draw and what to ask for have in common.

#include "client/hold/tile_cache.h"
#include "client/plan/selector.h"
#include "protocol/impostor/instance_group.h"

namespace mirage {

inline constexpr double kMinRadiusPx = 0.5;  ///< smaller objects are neither drawn nor asked for
inline constexpr double kMeshHysteresis = 1.15;  ///< what is drawn goes on for so much of the way
inline constexpr double kWalkingMps = 1.4;       ///< what may be expected of an eye that stands

/// Whether any picture of the object can stand for it: the eye is out of its sphere. False for NaN.
bool outside(const ViewGeometry& view);
/// The error in px this instance may show now.
double allowed_px(const SelectorInput& in, const Camera& camera, const InstanceView& view);
/// Whether the group stands for its members, if it has an image: it is far, and one lasts, even at
/// a walk. `slack` above 1 keeps one that does.
bool group_wanted(const SelectorInput& in, const InstanceView& view_of, const ViewGeometry& view,
                  double tau_px, double slack);
/// What the light of the instance's tiles costs by being past, px; 0 when it is not.
double light_change_px(const SelectorInput& in, const TileCache::LitGroup& lit,
                       std::uint32_t instance, double radius_px);
/// Nearer than this, in radii, the object may be geometry, if it is there; +inf: everywhere.
double swap_radii(const SelectorInput& in, const ObjectDescription& object);
/// Whether geometry of the object is asked for at this distance in radii, whatever it weighs beside
/// tiles of it.
bool comes_as_mesh(const SelectorInput& in, const ObjectDescription& object, double radii);
/// Whether, at the present lambda, geometry of the instance is better than a tile of it that shows
/// so much wrongly, px. True without geometry to compare.
bool mesh_pays(const SelectorInput& in, const Camera& camera, std::uint32_t instance,
               double tile_px);
/// Whether geometry is too dear even beside a tile that has aged, so that tiles are asked for.
bool too_dear(const SelectorInput& in, const Camera& camera, std::uint32_t instance, double tau_px);

}  // namespace mirage
