#pragma once
// The visible error of a coarser surface against the full one.

#include "server/lod/surface_distance.h"

namespace mirage {

/// Most vertices and triangles from which distances are measured.
struct DistanceSamples {
  std::size_t vertices = 20'000, triangles = 5'000;
};

/// A surface and its tree; coarser surfaces on the same vertices are measured against it.
class FullSurface {
 public:
  /// `vertices` and `indices` must outlive it. `radius`: of the surface, object units.
  FullSurface(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& indices,
              double radius, const DistanceSamples& samples, const Workers& workers);

  const SurfaceTree& tree() const { return tree_; }
  /// Returns, for each vertex, its place in the tree.
  const std::vector<std::uint32_t>& places() const { return places_; }
  /// True if the vertices differ in colour.
  bool colored() const { return colored_; }

  /// Returns the largest distance found between this surface and `coarse`, both ways
  /// (MeshLod::error), object units. If vertices are sampled, it is at least `estimate`. Above
  /// `allowed`, any larger value may be returned.
  double distance_to(const std::vector<std::uint32_t>& coarse, double estimate, double allowed,
                     const Workers& workers) const;
  /// True if too many vertex colours, such as baked light, would be lost with their vertices.
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
