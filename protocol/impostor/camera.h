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
  double fov_y = 1.0471975511965976;  ///< radians
  std::uint32_t width = 640;          ///< px
  std::uint32_t height = 360;         ///< px
  double near_m = 0.05;
  double far_m = 4000;
  glm::dvec2 shift_px{0};  ///< shifts the whole picture right and up; planning ignores it

  /// Sets near and far around a scene's bounding sphere, a ratio of 5e12; both ends do the same.
  void fit_depth_range(const glm::dvec3& scene_center, double scene_radius);
  double focal_px() const;
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
  /// A pair of planes whose normals lean away from the axis. There is no plane at half angles of 90
  /// degrees and more.
  struct Side {
    bool open = false;
    double cosine = 1, sine = 0;
  };
  static Side side(double half_angle);

  glm::dvec3 forward_, right_, up_;
  Side across_, along_;
};

/// Returns the pose at `eye` that looks at `target`, with world +Y up where possible.
Pose look_at(const glm::dvec3& eye, const glm::dvec3& target);

/// Returns the pose of a home view for a picture with the camera's shape and field of view. The eye
/// keeps its direction and goes where the points to fit lie in the middle and fill four fifths of
/// the picture's width or height, but no nearer than 1.8 times half the diagonal of
/// their box.
Pose home_pose(const HomeView& home, const Camera& camera);

}  // namespace mirage
