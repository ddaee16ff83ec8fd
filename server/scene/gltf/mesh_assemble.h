#pragma once
// RawPrimitive -> Mesh: defective and degenerate elements go, normals and tangents are completed,
// unused vertices are left out.

#include "protocol/model/model.h"
#include "server/scene/gltf/primitive_read.h"
#include "server/scene/gltf/tally.h"
#include "server/scene/unit_vectors.h"

namespace mirage::gltf {

/// Appends what is drawable of `raw` as one Primitive of `mesh`; nothing if nothing is left.
/// Every vertex written is finite, with unit normal and tangent. `raw` is left as it was written:
/// its `source` then tells where each vertex comes from.
void append_primitive(RawPrimitive& raw, std::uint32_t material, bool needs_tangents, Tally& tally,
                      Mesh& mesh);

/// Whether its tangents follow the surface: those of the file, or made of texture coordinates. Else
/// append_primitive gives any that are perpendicular to the normals.
bool has_tangents(const RawPrimitive& raw);

/// How many vertices append_primitive may add.
std::size_t vertices_needed(const RawPrimitive& raw);

/// Brings a mesh of extreme size to about 1 by a power of two, so that no picture of it changes,
/// and gives that power: what one unit of the mesh now is in units of the file. 1: left as it was.
double normalise_extent(Mesh& mesh);

}  // namespace mirage::gltf
