#pragma once
// Per-vertex animation data of a file: joints and weights, morph displacements.

#include "protocol/model/animation.h"
#include "server/scene/gltf/mesh_import.h"

namespace mirage::gltf {

/// Returns the four heaviest of JOINTS_n / WEIGHTS_n per vertex, with weights summing to 1; a
/// vertex without any has weight 0 in x. Empty, with a warning, if joints or weights cannot be
/// used. Errors, of a strict tally: those of the accessor reader.
Result<std::vector<VertexBinding>> read_influences(const Document& document,
                                                   const std::map<std::string, int>& attributes,
                                                   std::uint32_t joints, Tally& tally);

/// Returns target `target` of all primitives of a mesh: the vertices it moves, counted from
/// `first_vertex`. What cannot be used is left out and counted; an error if the tally is strict.
Result<MorphTarget> read_target(const Document& document, const tinygltf::Mesh& mesh,
                                std::size_t target, const std::vector<VertexOrigin>& origins,
                                std::size_t first_vertex, Tally& tally);

}  // namespace mirage::gltf
