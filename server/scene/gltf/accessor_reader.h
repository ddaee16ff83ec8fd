#pragma once
// Copies checked accessors into plain arrays. Strides, component types, normalisation and sparse
// substitution are resolved here.

#include <cstdint>
#include <vector>

#include "protocol/base/result.h"

namespace mirage::gltf {

struct Document;

bool is_unsigned_type(int component_type);
/// Returns one unsigned component of type 5121, 5123 or 5125 from unaligned bytes.
std::uint32_t load_unsigned(const std::uint8_t* source, int component_type);

/// Returns `components` floats per element. Normalised integers become 0..1 or -1..1 (glTF
/// §3.6.2.2), others keep their value (KHR_mesh_quantization). NaN and infinities pass through.
/// Errors: kSceneFormat if the accessor has another number of components, kSceneReference if its
/// buffer has no content.
Result<std::vector<float>> read_floats(const Document& document, int accessor,
                                       std::size_t components);

/// Returns unsigned integers in the same way, never normalised (indices, JOINTS_n).
Result<std::vector<std::uint32_t>> read_unsigned(const Document& document, int accessor,
                                                 std::size_t components);

}  // namespace mirage::gltf
