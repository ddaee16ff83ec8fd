#pragma once
// How well the view tile shows an object: one of the ways it may be drawn, and what others are
// asked for against.

#include <optional>

#include "protocol/impostor/camera.h"
namespace mirage {

struct InstanceView;
struct ViewTile;

/// A first image of an object, which has to be quick, is as coarse as this, px per tau: it is left
/// out where the view shows more.
inline constexpr double kFirstImagePx = 4;

class ViewFit {
 public:
  explicit ViewFit(const ViewTile& view);

  /// What it shows wrongly of an object, px on the screen of `camera`: the size of its texels, what
  /// a step of its depth moves, and how much comes out from behind the object's own front, from
  /// where the eye is now. An estimate, no bound: what hid the object from the view is not known.
  /// nullopt: it was not in the view, or is seen from too far aside.
  /// Of what comes out from behind, a seam here and there, `behind_share` counts.
  std::optional<double> error_px(const InstanceView& instance, const Camera& camera,
                                 double behind_share = 1) const;

 private:
  Camera camera_;
  double step_ = 0;  ///< of depth, a share of it
};

}  // namespace mirage
