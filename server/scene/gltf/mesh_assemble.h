#pragma once
// Turns a RawPrimitive into a Mesh: removes defective and degenerate elements, completes normals
// and tangents, and drops unused vertices.

#include "protocol/model/model.h"
#include "server/scene/gltf/primitive_read.h"
#include "server/scene/gltf/tally.h"
#include "server/scene/unit_vectors.h"

namespace mirage::gltf {

/// Appends the drawable part of `raw` as one Primitive of `mesh`; nothing if none is left. Every
/// vertex written is finite, with unit normal and tangent. `raw` is left in the written state, so
/// its `source` tells where each vertex comes from.
void append_primitive(RawPrimitive& raw, std::uint32_t material, bool needs_tangents, Tally& tally,
                      Mesh& mesh);

/// True if its tangents follow the surface: from the file, or made from texture coordinates.
/// Otherwise append_primitive uses arbitrary ones perpendicular to the normals.
bool has_tangents(const RawPrimitive& raw);

/// Returns the most vertices that append_primitive may add.
std::size_t vertices_needed(const RawPrimitive& raw);

/// Scales a mesh of extreme size to about 1 by a power of two, so that no picture of it changes.
/// Returns the size of one mesh unit in units of the file; 1: unchanged.
double normalise_extent(Mesh& mesh);

}  // namespace mirage::gltf
