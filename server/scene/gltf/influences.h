#pragma once
// Per-vertex data of an animation as the file has it: joints and weights, morph displacements.

#include "protocol/model/animation.h"
#include "server/scene/gltf/mesh_import.h"

namespace mirage::gltf {

/// The four heaviest of JOINTS_n / WEIGHTS_n per vertex, weights summing to 1; weight 0 in x where
/// a vertex has none. Empty, with a warning, where joints or weights are impossible. Errors: those
/// of the accessor reader.
Result<std::vector<VertexBinding>> read_influences(const Document& document,
                                                   const std::map<std::string, int>& attributes,
                                                   std::uint32_t joints, Tally& tally);

/// Target `target` of all primitives of a mesh: the vertices it moves, counted from
/// `first_vertex`.
Result<MorphTarget> read_target(const Document& document, const tinygltf::Mesh& mesh,
                                std::size_t target, const std::vector<VertexOrigin>& origins,
                                std::size_t first_vertex);

}  // namespace mirage::gltf
