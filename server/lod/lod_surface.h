#pragma once
// One primitive's surface on its way to fewer triangles.

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

/// Every triangle has vertices of its own: flat-shaded scans come so. Nothing would collapse.
bool is_soup(const Part& part);

/// How one is simplified and measured.
struct LodRules {
  bool soup = false;  ///< is_soup(): vertices that differ in normal and tangent only are one
  bool lock_border =
      false;  ///< vertices at an edge of one triangle stay: the surface goes on there
  DistanceSamples samples;
};

/// A surface of triangles that loses some step by step; each step is held against all of it.
class LodSurface {
 public:
  /// `part` must outlive it.
  LodSurface(const Part& part, const LodRules& rules, const Workers& workers);
  LodSurface(LodSurface&&) = delete;

  /// Goes on to about `triangles`, at most `allowed` (object units) from the whole. False where it
  /// finds no such step and all stays as it is.
  bool reduce(std::size_t triangles, double allowed, const Workers& workers);

  /// Present triangles, as indices of the part's vertices.
  const std::vector<std::uint32_t>& indices() const { return coarse_; }
  /// Of the present triangles (MeshLod::error), object units.
  double error() const { return error_; }
  /// Present triangles with normals of the whole surface where their own would shade wrongly.
  Level level(const Workers& workers) const;

 private:
  const Part& part_;
  std::vector<std::uint32_t> coarse_;
  std::vector<std::uint32_t> origin_;  ///< of soup only, by joined vertex: one that became it
  std::optional<SurfaceSimplifier> simplifier_;
  std::optional<FullSurface> surface_;
  double estimate_ = 0;  ///< sum of the simplifier's errors, object units
  double error_ = 0;
};

}  // namespace mirage
