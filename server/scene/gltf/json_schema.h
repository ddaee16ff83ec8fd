#pragma once
// The part of the glTF 2.0 schema that this importer reads. `sanitize` copies exactly that part,
// checked, so that the next parser never meets a wrong type or a dangling reference.

#include <nlohmann/json.hpp>

#include "protocol/base/result.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// Copies the known properties out of `document` (consumed: long strings are moved).
/// Types, required properties, list lengths and every index into another list are checked;
/// integral floats become integers; unknown properties, extensions and `extras` are left out.
/// What cannot be used costs itself and what means another thing without it (Flaw), and is counted.
/// Errors, of a strict tally or without `asset`: kSceneFormat (types), kSceneReference (indices),
/// kSceneRange (negative or huge numbers); the text names the element, as in
/// `accessors[3].bufferView`.
Result<nlohmann::json> sanitize(nlohmann::json&& document, Tally& tally);

}  // namespace mirage::gltf
