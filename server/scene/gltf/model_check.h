#pragma once
// Ranges: every bufferView lies in its buffer, every accessor in its bufferView, sparse indices
// increase. After this check accessors can be read without further tests.

#include "protocol/base/result.h"

namespace mirage::gltf {

struct Document;

/// Errors: kSceneRange, kSceneFormat, kSceneLimit; the text names the element.
Result<void> check_model(const Document& document);

/// Bytes of one component (5120…5126), 0 for a type that glTF does not know.
std::size_t component_bytes(int component_type);
/// Components of SCALAR…MAT4, 0 if unknown.
std::size_t component_count(int type);

}  // namespace mirage::gltf
