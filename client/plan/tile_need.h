#pragma once
// Tile need: which key to ask for. It is the capture that will serve longest along the eye's path,
// as fine as the bound requires, with the time for which it is expected to serve.

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
  bool first = false;       ///< in view, and nothing of its own is shown
  std::uint32_t light = 0;  ///< serial of its lighting (LightHistory)
  double error_px = 0;      ///< error of what is shown now
  double life_s = 0;        ///< time for which the new tile is expected to serve
  double gain = 0;          ///< its worth (ask_gain.h)
};

/// Values that a view is planned with. Lengths are in object units.
struct ViewPlan {
  double tau_px = 1;
  double pixel_px = 1;     ///< size of a drawn pixel on the shown picture, px, >= 1
  glm::dvec3 velocity{0};  ///< velocity of the eye relative to the object, units/s
  /// Largest depth difference between surface and drawn point, in radii. For a flat proxy it is the
  /// object's depth; with stored depth it is the part of the object's depth steps that tau allows
  /// as disocclusion.
  double depth_share = 0.5;
};

/// Depth share of flat proxies: half the visible depth of a ball; measured values are smaller.
inline constexpr double kFlatDepthShare = 0.5;
/// Returns how many times tau a disocclusion may be wide, 1 to kHoleTolerance (instance_group.h).
/// It is limited to a share of the projected radius `size_px`, so that a tile of a small object
/// does not serve from far aside.
double hole_tolerance(double tau_px, double size_px);

/// Returns the instance's view in object units, relative to its centre. A moving instance is seen
/// at `time_s` of the animation.
ViewGeometry view_geometry(const Camera& camera, const InstanceView& instance,
                           const ObjectDescription& object, double time_s = 0);
/// Returns the projected radius of the bounding sphere, px; +inf with the eye inside.
double radius_px(const ViewGeometry& view);

/// Returns how far, object units, the eye may be from the capture position before a tile exceeds
/// tau.
double allowed_baseline(const ViewGeometry& view, const ViewPlan& plan);
/// Returns the seconds for which a tile captured for this view is expected to serve, at most
/// kLongestLife.
double expected_life_s(const ViewGeometry& view, const ViewPlan& plan);

/// Returns the key to ask for. It is captured ahead on the eye's path, as far as it is already
/// valid here. Its cell lies within a fifth of the allowed baseline, at 1.5 texels per drawn pixel.
/// The radius must be above 0.
TileNeed need_for_view(const ViewGeometry& view, const ViewPlan& plan);

inline constexpr int kMaxAskedSizeClass = 12;  ///< 1024 texels
/// Returns the class of a quick first image: a quarter of the edge takes a sixteenth of the bytes.
std::uint8_t coarse_class(std::uint8_t size_class);

}  // namespace mirage
