#pragma once
// The viewer's camera. Matrices are relative to the eye: world positions have the eye subtracted
// in double before they become float (numerics.md section 3).

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace mirage {

struct Pose {
  glm::dvec3 eye{0};
  glm::quat rotation{1, 0, 0, 0};  ///< world_from_camera; the camera looks along its -z
};

/// How eye depth z becomes window depth. Reversed: near / z, without a far end, whose rounding in a
/// float is the same share of z everywhere (numerics.md section 3); it takes glClipControl. Forward
/// is what GLES has.
enum class DepthMapping : std::uint8_t { kForward, kReversed };

struct Camera {
  Pose pose;
  double fov_y = 1.0471975511965976;  ///< radians
  std::uint32_t width = 640;          ///< px
  std::uint32_t height = 360;         ///< px
  double near_m = 0.05;
  double far_m = 4000;
  glm::dvec2 shift_px{0};  ///< of all that is drawn, right and up; planning knows nothing of it

  /// Near and far around a scene's bounding sphere, the same on both ends: 5e12 apart.
  void fit_depth_range(const glm::dvec3& scene_center, double scene_radius);
  double focal_px() const;
  glm::dvec3 forward() const;
  glm::dvec3 right() const;
  glm::dvec3 up() const;
  /// clip_from_view * view_from_eye-relative world: multiply with (world - eye).
  glm::mat4 clip_from_relative(DepthMapping mapping = DepthMapping::kForward) const;
  /// Where the near plane is: forward depth cannot have it nearer than far / 5,000.
  double near_for(DepthMapping mapping) const;
  /// (x, y) so that window depth = x + y / eye depth.
  glm::dvec2 window_depth(DepthMapping mapping) const;
  /// Pixel of a point given relative to the eye (y down, pixel centres at +0.5); depth in z.
  glm::dvec3 pixel_from_relative(const glm::dvec3& relative) const;
};

/// The side planes of a camera's view grown by `guard` radians, to be asked many times.
class Frustum {
 public:
  explicit Frustum(const Camera& camera, double guard = 0);
  /// Whether a sphere (centre relative to the eye) can touch it.
  bool may_see(const glm::dvec3& center, double radius) const;

 private:
  /// A pair of planes whose normals lean from the axis; no plane from a right angle on.
  struct Side {
    bool open = false;
    double cosine = 1, sine = 0;
  };
  static Side side(double half_angle);

  glm::dvec3 forward_, right_, up_;
  Side across_, along_;
};

/// Looks from `eye` at `target`, world up +Y where that is possible.
Pose look_at(const glm::dvec3& eye, const glm::dvec3& target);

}  // namespace mirage
