#pragma once
// The proven bound, in pixels, on where an impostor draws the points of its object (numerics.md
// section 2). It tells the client when a better tile is needed.
//
// The bound rests on one exact identity. Oc is the capture eye, e the present eye, B = e - Oc the
// baseline. A capture ray is u = a + t, with a the capture axis, so that z is depth along it. A
// surface point P = Oc + zp u is drawn at Q = Oc + zq u. The present forward axis is n, and g
// is -n.B. Then:
//     err_px = f |1/zp - 1/zq| |n x (u x B)| / ((g/zp + n.u) (g/zq + n.u))
//
// |n x (u x B)| is convex and n.u linear in t, so over a window of tangents both are extreme at its
// corners; g/z is monotone in z. The rest is measured on the tile: the largest |1/zp - 1/zq|, the
// depth ranges and the window of its content.

#include <glm/glm.hpp>

namespace mirage {

/// All lengths in object units, positions relative to the object's centre.
struct ViewGeometry {
  double focal_px = 0;      ///< H / (2 tan(fovy/2))
  double radius = 0;        ///< of the bounding sphere
  glm::dvec3 eye{0};        ///< present eye
  double center_depth = 0;  ///< eye depth of the centre along `forward`
  double clip_time_s = 0;   ///< of the object's animation; ignored if static
  glm::dvec3 forward{0};    ///< present forward axis, unit; zero: unknown, the bound is looser
};

struct CaptureGeometry {
  glm::dvec3 axis{0, 0, 1};  ///< unit, centre -> capture eye
  double distance = 0;       ///< Dc = |Oc|
  /// Window of the content: tangents along two unit axes across `axis`. Zero axes: the bounding
  /// sphere's cone.
  glm::dvec3 right{0}, up{0};
  glm::dvec2 low{0}, high{0};
};

/// Depths at which a tile is drawn, along the capture axis.
struct DrawnDepth {
  double dz = 0;  ///< largest Dc^2 |1/z - 1/z_drawn|: depth error scaled to the centre
  double q = 0;   ///< largest distance of a drawn point from the centre
  /// Depth ranges of the surface and of the drawn points; 0, 0: unknown, taken from radius and q.
  double surface_min = 0, surface_max = 0;
  double drawn_min = 0, drawn_max = 0;
};

/// Returns the baseline term B1 = Bperp + |Baxis| tanA; +inf if the capture eye is inside the
/// sphere.
double baseline_term(const ViewGeometry& view, const CaptureGeometry& capture);
/// Returns the same term from scalars (D, theta), without cancellation at small angles.
double baseline_term(double distance, double capture_distance, double theta, double radius);

/// Returns the bound in px. It is +inf, never NaN, if no impostor can be trusted: the eye is inside
/// or nearer than kMinCaptureRadii radii, the centre depth is <= r, or an input is not finite.
double position_bound_px(const ViewGeometry& view, const CaptureGeometry& capture,
                         const DrawnDepth& drawn);

/// Returns the bound in px for an object that moved since its capture; it adds to
/// position_bound_px(). Two points of the sphere that lie `travel` object units apart have images
/// at most f travel / (cos w (zC - r)) apart. Here w is the largest angle off the forward axis of a
/// ray to the sphere.
///
/// This follows from the exact form |d - forward (p . d / z)| of point_error_px: the image of a
/// step d is at most |d| / (z cos w).
double motion_bound_px(const ViewGeometry& view, double travel);

/// Returns the true error in px of one point: `p` is the surface point, `q` the place where it is
/// drawn (same capture ray), `forward` the present unit forward axis. All are relative to the
/// present eye.
double point_error_px(double focal_px, const glm::dvec3& p, const glm::dvec3& q,
                      const glm::dvec3& forward, const glm::dvec3& right, const glm::dvec3& up);

/// Returns the size in px of one texel of a tile with `texels` over the sphere's full angle, seen
/// at the depth of the centre. footprint_px() is the part that adds to the error: half of the
/// excess over a pixel.
double texel_size_px(const ViewGeometry& view, const CaptureGeometry& capture, double texels);
double footprint_px(double texel_px);

/// Returns the largest size in px of a displacement by `error` object units of any point of the
/// object.
double lod_error_px(const ViewGeometry& view, double error);

/// True if a bound exceeds tau. NaN counts as stale.
inline bool is_stale(double bound_px, double tau_px) { return !(bound_px <= tau_px); }

}  // namespace mirage
