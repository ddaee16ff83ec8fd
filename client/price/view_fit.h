#pragma once
// View fit: how well the view tile shows an object. The view tile is one way to draw an object, and
// what asks are worth is measured against it.

#include <optional>

#include "protocol/impostor/camera.h"

namespace mirage {

struct InstanceView;
struct ObjectDescription;
struct ViewTile;

/// Error of the first image of an object, px per tau. It is coarse because it has to be quick; it
/// is left out where the view tile shows more.
inline constexpr double kFirstImagePx = 4;

/// Error, px, above which the view tile looks torn.
inline constexpr double kTornPx = 8;

class ViewFit {
 public:
  explicit ViewFit(const ViewTile& view);

  /// True if the instance is seen from about where the view was taken, and has not moved much
  /// since.
  bool shows(const InstanceView& instance, const ObjectDescription& object, const Camera& camera,
             double time_s) const;
  /// Estimates the error, px on the screen of `camera`, with which the view tile shows an object
  /// now. It adds the size of its texels, the shift by a step of its depth, and how much comes out
  /// from behind the object's own front. Only the share `behind_share` of the last term counts, for
  /// seams are rare. What moves counts as far as it has moved at `time_s`. It is no bound: what hid
  /// the object in the view is not known. Returns nullopt if the object was not in the view, or is
  /// seen from too far aside.
  std::optional<double> error_px(const InstanceView& instance, const ObjectDescription& object,
                                 const Camera& camera, double time_s,
                                 double behind_share = 1) const;

 private:
  /// Returns how far the object has moved since the view, px; nullopt: it was hidden then.
  std::optional<double> moved_px(const InstanceView& instance, const ObjectDescription& object,
                                 const Camera& camera, double time_s) const;

  Camera camera_;
  double time_s_ = 0;
  double near_m_ = 0;  ///< depth of the nearest surface
  double step_ = 0;    ///< depth step divided by the depth
};

}  // namespace mirage
