#pragma once
// The first levels of large surfaces, cut into chunks that all workers simplify at once.

#include "server/lod/lod_surface.h"

namespace mirage {

/// Primitives with more triangles are simplified in chunks until they are smaller.
inline constexpr std::size_t kLargeTriangles = 1'000'000;
inline constexpr std::size_t kChunkTriangles = 1 << 16;  ///< most triangles of one chunk

struct ChunkedStep {
  Part part;   ///< result on vertices of the whole, for the next step
  Part shown;  ///< the same triangles with restored normals (restore_normals())
  /// Object units: the largest distance of a chunk from its earlier surface, as in MeshLod::error.
  /// Chunks are measured one by one; the nearest point of the whole surface can only be nearer.
  double error = 0;
};

/// Returns `part` with about `triangles`; each chunk is at most `allowed` object units from its
/// earlier surface. Chunks are spatial neighbours. Triangles at their borders stay, so that chunks
/// still meet; the next step cuts elsewhere. `soup`: is_soup(). The number of workers changes
/// nothing.
ChunkedStep simplify_in_chunks(const Part& part, std::size_t triangles, double allowed, bool soup,
                               const Workers& workers,
                               std::size_t chunk_triangles = kChunkTriangles);

}  // namespace mirage
