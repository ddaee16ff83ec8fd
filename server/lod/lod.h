#pragma once
// Levels of detail, made once when a scene is loaded.

#include <vector>

#include "protocol/model/model.h"
#include "server/base/workers.h"

namespace mirage {

/// A coarser form of a mesh. Vertices are some of the full mesh's (with the normal of the surface
/// beside them where their own would shade a collapsed bevel), or pieces of it enlarged.
struct MeshLod {
  Mesh mesh;
  /// Object units: largest distance found between the connected surfaces of this level and of the
  /// full mesh, from vertices of the full mesh (at most 20,000 a primitive) to this level and from
  /// the middles of this level's triangles to the full mesh. Where vertices were sampled, not less
  /// than the simplifier's own estimate. Of a primitive of more than kLargeTriangles the sum over
  /// the steps in chunks (lod_chunks.h), each so measured against the surface before it, and of
  /// this.
  float error = 0;
  /// Object units; above 0: foliage was thinned, and 95 % of the dropped pieces have a kept one
  /// within this distance (between middles). No bound: tiles are never drawn from such a level.
  float spread = 0;
  /// Object units: shading_size() of it beside the full mesh; 0 where foliage was thinned.
  float shading = 0;
};

/// The chain below the full mesh, finest first: each level about a third of the triangles of the
/// one before, until it is small or shrinks no further; at most limits::kMaxLods - 1. Triangles of
/// one primitive never become another's; lines and points stay as they are. Seams stay closed.
/// Primitives of alpha-tested, blended or double-sided materials that consist of many small pieces
/// are thinned: a share of the pieces (chosen by hash, the same on every run) stays, enlarged about
/// their middles so that the covered area stays (R. L. Cook et al., "Stochastic simplification of
/// aggregate detail", 2007). A pure function of its input: the same
/// however many work at it.
/// `images` are those the materials' maps refer to.
std::vector<MeshLod> build_lods(const Mesh& full, const std::vector<Material>& materials,
                                const std::vector<Image>& images,
                                const Workers& workers = Workers());

}  // namespace mirage
