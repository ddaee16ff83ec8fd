#pragma once
// The part of the glTF 2.0 schema that this importer reads. `sanitize` copies exactly that part,
// checked, so that the next parser never meets a wrong type or a dangling reference.

#include <nlohmann/json.hpp>

#include "protocol/base/result.h"

namespace mirage::gltf {

/// Copies the known properties out of `document` (consumed: long strings are moved).
/// Types, required properties, list lengths and every index into another list are checked;
/// integral floats become integers; unknown properties, extensions and `extras` are left out.
/// Errors: kSceneFormat (types), kSceneReference (indices), kSceneRange (negative or huge numbers);
/// the text names the element, as in `accessors[3].bufferView`.
Result<nlohmann::json> sanitize(nlohmann::json&& document);

}  // namespace mirage::gltf
