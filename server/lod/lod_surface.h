#pragma once
// The surface of one primitive as it loses triangles.

#include <optional>

#include "server/lod/lod_normals.h"
#include "server/lod/surface_simplifier.h"

namespace mirage {

/// One primitive on its own vertices.
struct Part {
  PrimitiveKind kind = PrimitiveKind::kTriangles;
  std::uint32_t material = 0;
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;

  std::size_t triangles() const { return indices.size() / 3; }
};

/// True if almost every triangle has its own vertices, as in flat-shaded scans. Such a part would
/// not simplify.
bool is_soup(const Part& part);

/// Rules for simplifying and measuring a part.
struct LodRules {
  bool soup = false;  ///< is_soup(): joins vertices that differ only in normal and tangent
  bool lock_border =
      false;  ///< keeps vertices at edges of one triangle: the surface continues there
  DistanceSamples samples;
};

/// A surface of triangles that is reduced step by step. Each step is measured against the full
/// surface.
class LodSurface {
 public:
  /// `part` must outlive it.
  LodSurface(const Part& part, const LodRules& rules, const Workers& workers);
  LodSurface(LodSurface&&) = delete;

  /// Reduces to about `triangles`, at most `allowed` object units from the full surface. False: no
  /// such step was found, and nothing changed.
  bool reduce(std::size_t triangles, double allowed, const Workers& workers);

  /// Returns the present triangles, as indices of the part's vertices.
  const std::vector<std::uint32_t>& indices() const { return coarse_; }
  /// Returns the error of the present triangles (MeshLod::error), object units.
  double error() const { return error_; }
  /// Returns the present triangles, with normals of the full surface where their own would shade
  /// wrongly. The reference is valid until the next reduce().
  const Level& level(const Workers& workers);

 private:
  const Part& part_;
  std::vector<std::uint32_t> coarse_;
  /// soup only, by joined vertex: one of the vertices it replaces
  std::vector<std::uint32_t> origin_;
  std::optional<SurfaceSimplifier> simplifier_;
  std::optional<FullSurface> surface_;
  double estimate_ = 0;  ///< sum of the simplifier's errors, object units
  double error_ = 0;
  std::optional<Level> level_;  ///< of the present triangles, once asked for
  double stuck_at_ = -1;        ///< an allowed error, object units, with which no step was found
};

}  // namespace mirage
