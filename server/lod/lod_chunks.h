#pragma once
// The first levels of large surfaces: cut into chunks, which all workers simplify at once.

#include "server/lod/lod_surface.h"

namespace mirage {

/// Primitives of more triangles are simplified in chunks, until they are smaller than that.
inline constexpr std::size_t kLargeTriangles = 1'000'000;
inline constexpr std::size_t kChunkTriangles = 1 << 16;  ///< at most, of one chunk

struct ChunkedStep {
  Part part;   ///< what is left, on vertices of the whole: for the next step
  Part shown;  ///< the same triangles, with normals restored (restore_normals())
  /// Object units: no chunk is farther from what it was, as MeshLod::error has it. Measured chunk
  /// by chunk: the nearest point of the whole surface can only be nearer.
  double error = 0;
};

/// `part` with about `triangles`, each chunk at most `allowed` (object units) from what it was.
/// Chunks are neighbours in space. Triangles at their borders stay, so that chunks still meet; the
/// next step cuts elsewhere. `soup`: is_soup(). The same however many work at it.
ChunkedStep simplify_in_chunks(const Part& part, std::size_t triangles, double allowed, bool soup,
                               const Workers& workers,
                               std::size_t chunk_triangles = kChunkTriangles);

}  // namespace mirage
