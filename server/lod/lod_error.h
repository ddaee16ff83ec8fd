#pragma once
// What a coarser surface shows wrongly of the full one.

#include "server/lod/surface_distance.h"

namespace mirage {

/// How many of a surface's things distances are taken from, at most.
struct DistanceSamples {
  std::size_t vertices = 20'000, triangles = 5'000;
};

/// One surface and its tree, to measure coarser ones of the same vertices against.
class FullSurface {
 public:
  /// `vertices` and `indices` must outlive it. `radius`: of the surface, object units.
  FullSurface(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& indices,
              double radius, const DistanceSamples& samples, const Workers& workers);

  const SurfaceTree& tree() const { return tree_; }
  /// By vertex: where in the tree it is.
  const std::vector<std::uint32_t>& places() const { return places_; }
  /// Vertices differ in colour.
  bool colored() const { return colored_; }

  /// Largest distance found between this surface and `coarse`, both ways (MeshLod::error), object
  /// units, not less than `estimate` where vertices are sampled. Above `allowed`: anything above
  /// it, as it then does not matter how much.
  double distance_to(const std::vector<std::uint32_t>& coarse, double estimate, double allowed,
                     const Workers& workers) const;
  /// Colours of vertices, such as baked light, go with the vertices: whether too many would show.
  bool loses_colors(const std::vector<std::uint32_t>& coarse, const Workers& workers) const;

 private:
  const std::vector<Vertex>& vertices_;
  const double radius_;
  const DistanceSamples samples_;
  const SurfaceTree tree_;
  const std::vector<std::uint32_t> places_;
  bool colored_ = false;
};

}  // namespace mirage
