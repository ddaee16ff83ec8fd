#pragma once
// Levels of detail, made when a scene is loaded.

#include <vector>

#include "protocol/model/model.h"
#include "server/base/workers.h"

namespace mirage {

/// A coarser form of a mesh. Its vertices are vertices of the full mesh, or pieces of it enlarged.
/// A vertex whose own normal would shade a collapsed bevel has the normal of the surface beside it.
struct MeshLod {
  Mesh mesh;
  /// Object units: the largest distance found between the connected surfaces of this level and of
  /// the full mesh. It is measured from vertices of the full mesh (at most 20,000 a primitive) to
  /// this level, and from the middles of this level's triangles to the full mesh. If vertices were
  /// sampled, it is at least the simplifier's own estimate.
  ///
  /// For a primitive of more than kLargeTriangles it is a sum: the errors of the steps in chunks
  /// (lod_chunks.h), each measured against the surface before it, and that of this step.
  float error = 0;
  /// Object units. Above 0, foliage was thinned, and 95 % of the dropped pieces have a kept one
  /// within this distance (between middles). Where pieces are much longer than the way to the next,
  /// as blades are, 95 % of the enlarged ones end within it from where they ended. It is no bound:
  /// tiles are never drawn from such a level.
  float spread = 0;
  /// Object units: MeshShading::size_of() against the full mesh; 0 if foliage was thinned.
  float shading = 0;
};

/// Returns the chain below the full mesh, finest first. Each level has about a third of the
/// triangles of the one before, until it is small or shrinks no further; at most limits::kMaxLods -
/// 1 levels. Triangles stay in their primitive, lines and points stay unchanged, seams stay closed.
///
/// Primitives of alpha-tested, blended or double-sided materials that consist of many small pieces
/// are thinned. A share of the pieces, chosen by hash, is kept and enlarged about their middles, so
/// that the covered area stays the same (R. L. Cook et al., "Stochastic simplification of aggregate
/// detail", 2007).
///
/// A pure function: the number of workers changes nothing. `images` are those that the materials'
/// maps refer to.
std::vector<MeshLod> build_lods(const Mesh& full, const std::vector<Material>& materials,
                                const std::vector<Image>& images,
                                const Workers& workers = Workers());

}  // namespace mirage
