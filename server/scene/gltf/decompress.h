#pragma once
// Compressed geometry -> plain bufferViews and accessors, in the sanitised JSON: what comes after
// does not know that it was ever compressed.

#include <nlohmann/json.hpp>

#include "protocol/base/result.h"
#include "server/base/workers.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// The two names of the meshopt extension; the younger one's additions are refused where met.
inline constexpr const char* kMeshoptExtensions[] = {"EXT_meshopt_compression",
                                                     "KHR_meshopt_compression"};

/// EXT_meshopt_compression: each compressed bufferView of `root` gets a buffer of its own.
/// Errors: those of decode_meshopt, kSceneRange (bytes outside their buffer), kSceneReference (a
/// buffer without content); the text names the bufferView.
Result<void> decompress_views(nlohmann::json& root, Document& document, const Workers& workers);

/// KHR_draco_mesh_compression: each compressed primitive gets accessors of its own, of the counts
/// that were decoded. Forgiven: other counts than declared. Errors: as above, of decode_draco.
Result<void> decompress_primitives(nlohmann::json& root, Document& document, const Workers& workers,
                                   Tally& tally);

}  // namespace mirage::gltf
