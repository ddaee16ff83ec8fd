#pragma once
// The viewer's camera. Matrices are relative to the eye: world positions have the eye subtracted
// in double before they become float (numerics.md section 3).

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace mirage {

struct HomeView;

struct Pose {
  glm::dvec3 eye{0};
  glm::quat rotation{1, 0, 0, 0};  ///< world_from_camera; the camera looks along its -z
};

/// Mapping of eye depth z to window depth. Reversed is near / z without a far plane: in a float its
/// rounding is the same fraction of z everywhere (numerics.md section 3). It needs glClipControl.
/// Forward is the mapping of GLES.
enum class DepthMapping : std::uint8_t { kForward, kReversed };

/// Returns the factor for clip coordinates that brings w at depth `z` (above 0) to [1, 2). It is a
/// power of two, so it changes no bit of what is drawn. Graphics cards drop triangles whose w is
/// tiny: a scene of 1e-20 m was not drawn at all.
double clip_scale(double z);

struct Camera {
  Pose pose;
  /// Angle, radians: twice the arc tangent of half the picture's height at distance 1.
  double fov_y = 1.0471975511965976;
  std::uint32_t width = 640;   ///< px
  std::uint32_t height = 360;  ///< px
  double near_m = 0.05;
  double far_m = 4000;
  glm::dvec2 shift_px{0};   ///< from the picture's middle right and up to where the camera looks
  double pixel_aspect = 1;  ///< width over height of what a pixel shows

  /// Sets near and far around a scene's bounding sphere, a ratio of 5e12; both ends do the same.
  void fit_depth_range(const glm::dvec3& scene_center, double scene_radius);
  /// Returns the distance in pixels at which a pixel is a pixel wide or high, the greater of both.
  double focal_px() const;
  /// Returns the tangents of half the angles across and along, if the camera looked at the middle.
  glm::dvec2 half_tangents() const;
  /// Returns this camera for a picture of another size.
  Camera at_size(std::uint32_t other_width, std::uint32_t other_height) const;
  /// Returns a camera that looks at the middle of its picture, has square pixels and sees all that
  /// this one does; this one itself, if it is such a camera.
  Camera enclosing() const;
  glm::dvec3 forward() const;
  glm::dvec3 right() const;
  glm::dvec3 up() const;
  /// Returns clip_from_view * view_from_relative: multiply it with (world - eye). It is scaled so
  /// that w is 1 to 2 at far_m.
  glm::mat4 clip_from_relative(DepthMapping mapping = DepthMapping::kForward) const;
  /// Returns the near distance, m. Forward depth allows none below far / 5,000.
  double near_for(DepthMapping mapping) const;
  /// Returns (x, y) such that window depth = x + y / eye depth.
  glm::dvec2 window_depth(DepthMapping mapping) const;
  /// Returns the eye depth of a point whose clip-space w is 1, m.
  double depth_of_w() const { return 1 / clip_scale(far_m); }
  /// Returns the pixel of a point relative to the eye (y down, pixel centres at +0.5), and its eye
  /// depth in z.
  glm::dvec3 pixel_from_relative(const glm::dvec3& relative) const;
};

/// Side planes of a camera's view, widened by `guard` radians; computed once for many tests.
class Frustum {
 public:
  explicit Frustum(const Camera& camera, double guard = 0);
  /// True if a sphere (centre relative to the eye) may touch the view.
  bool may_see(const glm::dvec3& center, double radius) const;

 private:
  /// A plane whose normal leans away from the axis. There is none at angles of 90 degrees and more.
  struct Side {
    bool open = false;
    double cosine = 1, sine = 0;
  };
  static Side side(double angle);

  glm::dvec3 forward_, right_, up_;
  Side to_right_, to_left_, upward_, downward_;
};

/// Tangents of the angles between the direction of view and the edges of a picture, with signs:
/// left and down are below right and up (as XrFovf of OpenXR, which has the angles).
struct ViewTangents {
  double left = -1, right = 1, down = -1, up = 1;
};

/// Sets field of view, shift and shape of pixels of a camera whose size is set. Tangents that
/// enclose nothing, or are not finite, leave it as it is; returns false then.
bool set_tangents(Camera& camera, const ViewTangents& tangents);

/// Returns the pose at `eye` that looks at `target`, with world +Y up where possible.
Pose look_at(const glm::dvec3& eye, const glm::dvec3& target);

/// Returns the pose of a home view for a picture with the camera's shape and field of view. The eye
/// keeps its direction and goes where the points to fit lie in the middle and fill four fifths of
/// the picture's width or height, but no nearer than 1.2 times half the diagonal of their box.
Pose home_pose(const HomeView& home, const Camera& camera);

}  // namespace mirage
