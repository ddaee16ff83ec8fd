#pragma once
// The proven bound, in pixels, of where an impostor draws the points of its object (numerics.md
// section 2). Every decision of the client is made with it.
//
// One exact identity carries it. Capture eye Oc, present eye e, baseline B = e - Oc, capture ray
// u = a + t with a the capture axis (so z is depth along it); a surface point P = Oc + zp u is
// drawn at Q = Oc + zq u; n is the present forward axis, g = -n.B:
//     err_px = f |1/zp - 1/zq| |n x (u x B)| / ((g/zp + n.u) (g/zq + n.u))
// |n x (u x B)| is convex and n.u linear in t, so over a window of tangents both are extreme at its
// corners; g/z is monotone in z. What remains is measured on the tile: the largest |1/zp - 1/zq|,
// the depth ranges and the window of its content.

#include <glm/glm.hpp>

namespace mirage {

/// All lengths in object units, positions relative to the object's centre.
struct ViewGeometry {
  double focal_px = 0;      ///< H / (2 tan(fovy/2))
  double radius = 0;        ///< of the bounding sphere
  glm::dvec3 eye{0};        ///< present eye
  double center_depth = 0;  ///< eye depth of the centre along the present forward axis
  double clip_time_s = 0;   ///< of the object's animation; no meaning for a static one
  glm::dvec3 forward{0};    ///< that axis, unit; zero when not known: a looser bound
};

struct CaptureGeometry {
  glm::dvec3 axis{0, 0, 1};  ///< unit, centre -> capture eye
  double distance = 0;       ///< Dc = |Oc|
  /// Window of the content: tangents along two unit axes across `axis`. Zero axes: the bounding
  /// sphere's cone.
  glm::dvec3 right{0}, up{0};
  glm::dvec2 low{0}, high{0};
};

/// How a tile is drawn. Depths are along the capture axis.
struct DrawnDepth {
  double dz = 0;  ///< largest Dc^2 |1/z - 1/z_drawn|: a depth difference brought to the centre
  double q = 0;   ///< largest distance of a drawn point from the centre
  /// Ranges of the surface and of the drawn points; 0, 0: as far as radius and q allow.
  double surface_min = 0, surface_max = 0;
  double drawn_min = 0, drawn_max = 0;
};

/// B1 = Bperp + |Baxis| tanA, the baseline term. +inf when the capture is inside the sphere.
double baseline_term(const ViewGeometry& view, const CaptureGeometry& capture);
/// The same from scalars, free of cancellation for small angles (used where D, theta are given).
double baseline_term(double distance, double capture_distance, double theta, double radius);

/// Bound in px; +inf (never NaN) wherever no impostor can be trusted: eye inside or nearer than
/// kMinCaptureRadii radii, centre depth <= r, any non-finite input.
double position_bound_px(const ViewGeometry& view, const CaptureGeometry& capture,
                         const DrawnDepth& drawn);

/// Bound in px of the image distance of two points of the sphere that lie `travel` object units
/// apart: f travel / (cos w (zC - r)), w the largest angle of a ray to the sphere off the forward
/// axis. It adds to the above where the object has moved since the capture. From the exact form
/// |d - forward (p . d / z)| of point_error_px: the image of a step d is at most |d| / (z cos w).
double motion_bound_px(const ViewGeometry& view, double travel);

/// True error in px of one point: `p` the surface point, `q` where it is drawn (same capture ray),
/// `forward` the present unit forward axis; all relative to the present eye.
double point_error_px(double focal_px, const glm::dvec3& p, const glm::dvec3& q,
                      const glm::dvec3& forward, const glm::dvec3& right, const glm::dvec3& up);

/// Size in px of one texel of a tile with `texels` over the sphere's full angle, seen at the
/// depth of the centre; and the part of it that adds to the error: half of what exceeds a
/// pixel.
double texel_size_px(const ViewGeometry& view, const CaptureGeometry& capture, double texels);
double footprint_px(double texel_px);

/// Size in px, at most, of a displacement by `error` (object units) of any point of the object.
double lod_error_px(const ViewGeometry& view, double error);

/// Stale test: written so that NaN counts as stale.
inline bool is_stale(double bound_px, double tau_px) { return !(bound_px <= tau_px); }

}  // namespace mirage
