#pragma once
// Rules that are the same for deciding what to draw and what to ask for.

#include "client/hold/tile_cache.h"
#include "client/plan/selector_input.h"
#include "protocol/impostor/instance_group.h"

namespace mirage {

inline constexpr double kMinRadiusPx = 0.5;  ///< smaller objects are neither drawn nor asked for
inline constexpr double kMeshHysteresis = 1.15;  ///< slack that favours what is drawn now
inline constexpr double kWalkingMps = 1.4;       ///< speed that a still eye may take up

/// True if a picture can stand for the object: the eye is outside its sphere. False for NaN.
bool outside(const ViewGeometry& view);
/// Returns the error, px, that this instance may show now.
double allowed_px(const SelectorInput& in, const Camera& camera, const InstanceView& view);
/// True if an image of the group may stand for its members: the group is far, and a tile lasts,
/// even at a walk. `slack` above 1 keeps a group that already stands for them.
bool group_wanted(const SelectorInput& in, const InstanceView& view_of, const ViewGeometry& view,
                  double tau_px, double slack);
/// Returns the error, px, by which the light of the instance's tiles is out of date; 0: it is not.
double light_change_px(const SelectorInput& in, const TileCache::LitGroup& lit,
                       std::uint32_t instance, double radius_px);
/// Returns the distance, in radii, within which the object may be drawn as geometry, if that is
/// here; +inf: everywhere.
double swap_radii(const SelectorInput& in, const ObjectDescription& object);
/// True if geometry of the object is asked for at this distance in radii, however its bytes compare
/// with those of tiles.
bool comes_as_mesh(const SelectorInput& in, const ObjectDescription& object, double radii);
/// True if, at the present lambda, geometry of the instance is better than a tile of it with an
/// error of `tile_px`. True without geometry to compare.
bool mesh_pays(const SelectorInput& in, const Camera& camera, std::uint32_t instance,
               double tile_px);
/// Returns the error, px, of a tile towards the end of its life: 2 to 8 tau. `life_s` is the life
/// of a fresh one. While the next one is on its way, the eye moves on, so a near tile is many lives
/// old.
double aged_tile_px(double tau_px, double life_s);
/// Returns how the radians by which the line of sight has turned since the tile's capture look, px
/// of a tile's error: surfaces that it could not see, and reflections that have changed. The bound
/// does not cover them.
double unseen_px(const TileRecord& tile, const ViewGeometry& view);
/// Returns that turn, radians.
double turned_since(const TileRecord& tile, const ViewGeometry& view);
/// True if geometry is too expensive even beside a tile that has aged, so that tiles are asked for.
bool too_dear(const SelectorInput& in, const Camera& camera, std::uint32_t instance, double tau_px);

}  // namespace mirage
