#pragma once
// The capture camera of a tile (TECHNIQUES row 17). It stands at the key's distance on the view
// cell's axis and looks at the object's centre; its window encloses the bounding sphere. Both ends
// derive it from the key, so it never travels.

#include <glm/glm.hpp>

#include "protocol/impostor/error_bound.h"
#include "protocol/impostor/tile.h"
#include "protocol/impostor/tile_key.h"
#include "protocol/impostor/view_cell.h"

namespace mirage {

/// Positions relative to the object's centre, in object units.
struct Capture {
  CaptureBasis basis;
  double radius = 0;
  double distance = 0;      ///< Dc
  double half_tangent = 0;  ///< half the window, at depth 1
  std::uint32_t edge = 0;
  int view_level = 0;  ///< level of the view cell: how far the eye may be off axis

  Capture() = default;
  Capture(const ViewCell& cell, const DistanceBucket& bucket, double radius_in,
          std::uint32_t edge_in)
      : basis(capture_basis(cell)),
        radius(radius_in),
        distance(radii_from_distance_bucket(bucket) * radius_in),
        half_tangent(capture_half_tangent(radius_in, distance, edge_in)),
        edge(edge_in),
        view_level(cell.level) {}

  glm::dvec3 eye() const { return basis.forward * -distance; }
  /// Returns the geometry with the window of `crop`, grown by half a texel because bilinear
  /// filtering reaches that far.
  CaptureGeometry geometry(const TileCrop& crop) const {
    const double step = 2.0 * half_tangent / edge;
    const glm::dvec2 low(crop.x - 0.5, edge - (crop.y + crop.h + 0.5));
    const glm::dvec2 size(crop.w + 1.0, crop.h + 1.0);
    return {-basis.forward,
            distance,
            basis.right,
            basis.up,
            low * step - half_tangent,
            (low + size) * step - half_tangent};
  }
  CaptureGeometry geometry() const { return {-basis.forward, distance, {}, {}, {}, {}}; }
  /// Returns the depth of `p` along the capture axis.
  double depth(const glm::dvec3& p) const { return distance + glm::dot(p, basis.forward); }
  /// Returns tile coordinates in texels; (0,0) is the outer corner of the top left texel.
  glm::dvec2 texel_from_point(const glm::dvec3& p) const {
    const double scale = 0.5 * edge / (depth(p) * half_tangent);
    return {0.5 * edge + glm::dot(p, basis.right) * scale,
            0.5 * edge - glm::dot(p, basis.up) * scale};
  }
  /// Returns the point at capture depth `z` on the ray through tile coordinate `t`.
  glm::dvec3 point_from_texel(const glm::dvec2& t, double z) const {
    const double x = (t.x / edge * 2.0 - 1.0) * half_tangent * z;
    const double y = (1.0 - t.y / edge * 2.0) * half_tangent * z;
    return basis.right * x + basis.up * y + basis.forward * (z - distance);
  }
  /// Returns the width of a texel at depth z, object units.
  double texel_width(double z) const { return 2.0 * half_tangent * z / edge; }
  /// Returns by how much the stored depth of a surface at depth z may be too large, object units.
  /// Clients draw the tile nearer by it, so that geometry it stands on does not cover it.
  double depth_slack(double z) const {
    return DepthCode(radius, distance).quantum() + texel_width(z);
  }
};

}  // namespace mirage
