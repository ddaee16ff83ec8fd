#pragma once
// Checks ranges: every bufferView is inside its buffer, every accessor inside its bufferView, and
// sparse indices increase. Afterwards accessors can be read without further checks.

#include "protocol/base/result.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

struct Document;

/// Empties each bufferView and accessor that cannot be used, so that whoever reads it gets an
/// error. Errors, of a strict tally: kSceneRange, kSceneFormat, kSceneLimit; the text names the
/// element.
Result<void> check_model(Document& document, Tally& tally);

/// Returns the bytes of one component (5120…5126), 0 for a type unknown to glTF.
std::size_t component_bytes(int component_type);
/// Returns the components of SCALAR…MAT4, 0 if unknown.
std::size_t component_count(int type);

}  // namespace mirage::gltf
