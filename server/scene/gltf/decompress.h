#pragma once
// Turns compressed geometry into plain bufferViews and accessors in the sanitised JSON. Later
// stages do not see that it was compressed.

#include <nlohmann/json.hpp>

#include "protocol/base/result.h"
#include "server/base/workers.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// The two names of the meshopt extension. Additions of the younger one are refused.
inline constexpr const char* kMeshoptExtensions[] = {"EXT_meshopt_compression",
                                                     "KHR_meshopt_compression"};

/// EXT_meshopt_compression: gives each compressed bufferView of `root` its own buffer. Errors:
/// kSceneLimit, kSceneExtension (not built in); of a strict tally also those of decode_meshopt,
/// kSceneRange (bytes outside their buffer), kSceneReference (a buffer without content), which
/// otherwise cost the bufferView; the text names the bufferView.
Result<void> decompress_views(nlohmann::json& root, Document& document, const Workers& workers,
                              Tally& tally);

/// KHR_draco_mesh_compression: gives each compressed primitive its own accessors, with the decoded
/// counts. Counts that differ from the declared ones are forgiven. Errors: as above, with those of
/// decode_draco, which cost the primitive.
Result<void> decompress_primitives(nlohmann::json& root, Document& document, const Workers& workers,
                                   Tally& tally);

}  // namespace mirage::gltf
