#pragma once
// Which key to ask for: the capture that will serve longest along the eye's path, at the fineness
// the bound allows, and how long it is expected to serve.

#include "protocol/impostor/error_bound.h"
#include "protocol/impostor/motion.h"
#include "protocol/impostor/tile_key.h"
#include "protocol/impostor/view_cell.h"

namespace mirage {

struct Camera;
struct InstanceView;
struct ObjectDescription;

/// A tile worth asking for.
struct TileNeed {
  std::uint32_t instance = 0;
  ViewCell cell;
  DistanceBucket distance;
  std::uint8_t size_class = 0;
  Phase phase = kStaticPhase;
  std::uint8_t channels = kLitTile;
  bool first = false;       ///< it is in view and nothing of its own is shown for it
  std::uint32_t light = 0;  ///< serial of the lighting it is for (LightHistory)
  double error_px = 0;      ///< what showing the present state costs
  double life_s = 0;        ///< for which the new tile is expected to serve
  double gain = 0;          ///< what it is worth (ask_gain.h)
};

/// What a view is planned with. Lengths in object units.
struct ViewPlan {
  double tau_px = 1;
  glm::dvec3 velocity{0};  ///< of the eye relative to the object, units/s
  /// Largest depth difference between surface and drawn point, in radii: of a flat proxy, or with
  /// stored depth the part of the object's depth steps that tau allows as disocclusion.
  double depth_share = 0.5;
};

/// The depth share of flat proxies: half the visible depth of a ball; measured values are smaller.
inline constexpr double kFlatDepthShare = 0.5;
/// How many times tau a disocclusion may be wide, 1 to kHoleTolerance (instance_group.h): on a
/// small object it may not be more than a share of its projected radius `size_px`, or the tile
/// would serve from far aside.
double hole_tolerance(double tau_px, double size_px);

/// The instance's view in object units, relative to its centre; a moving one at `time_s` of the
/// animation.
ViewGeometry view_geometry(const Camera& camera, const InstanceView& instance,
                           const ObjectDescription& object, double time_s = 0);
/// Projected radius of the bounding sphere in px; +inf with the eye inside.
double radius_px(const ViewGeometry& view);

/// How far the eye may be from the capture position before a tile exceeds tau, object units.
double allowed_baseline(const ViewGeometry& view, const ViewPlan& plan);
/// Seconds a tile captured for this view is expected to serve, at most kLongestLife.
double expected_life_s(const ViewGeometry& view, const ViewPlan& plan);

/// The key to ask for: captured ahead on the eye's path as far as it is already valid here, its
/// cell within a fifth of the allowed baseline, at 1.5 texels per pixel. The radius is above 0.
TileNeed need_for_view(const ViewGeometry& view, const ViewPlan& plan);

inline constexpr int kMaxAskedSizeClass = 12;  ///< 1024 texels
/// Something quick first: a quarter of the edge is a sixteenth of the bytes.
std::uint8_t coarse_class(std::uint8_t size_class);

}  // namespace mirage
