#pragma once
// Reads one glTF primitive into plain arrays: attributes widened to float, indices expanded to
// lists, morph targets and skin applied at the rest pose.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/model/model.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// Attribute lists are empty or as long as `position`. `indices` hold whole triangles, lines or
/// points, and may still exceed the vertices.
struct RawPrimitive {
  PrimitiveKind kind = PrimitiveKind::kTriangles;
  std::vector<glm::vec3> position;
  std::vector<glm::vec3> normal;
  std::vector<glm::vec4> tangent;
  std::vector<glm::vec2> uv0;
  std::vector<glm::vec2> uv1;
  std::vector<glm::u16vec4> color;
  std::vector<std::uint32_t> source;  ///< index of each vertex in the file; empty: not requested
  std::vector<std::uint32_t> indices;
};

/// The pose of a mesh where a node draws it.
struct Pose {
  std::vector<double> weights;             ///< morph weights; missing ones are 0
  std::vector<glm::dmat4> joint_matrices;  ///< world_from_bind per joint; empty: not skinned
};

/// Expands strips, fans and loops (glTF §3.7.2.1) into independent elements.
std::vector<std::uint32_t> expand_indices(std::vector<std::uint32_t> indices, int mode);

/// Reads a primitive. An attribute that cannot be used is left out and counted. Errors: those of
/// positions, indices and the mode, and all of a strict tally: kSceneFormat (wrong type),
/// kSceneReference (no data), kSceneRange (another count than that of positions), kSceneLimit.
Result<RawPrimitive> read_primitive(const Document& document, const tinygltf::Primitive& source,
                                    const Pose& pose, Tally& tally);

/// Returns the coordinates of a set, TEXCOORD_n, one for each position of `raw`; none: the
/// primitive lacks usable ones. Errors: those of a strict tally.
Result<std::vector<glm::vec2>> read_uv_set(const Document& document,
                                           const tinygltf::Primitive& source, int set,
                                           const RawPrimitive& raw, Tally& tally);

}  // namespace mirage::gltf
