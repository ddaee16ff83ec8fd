#pragma once
// One object as geometry: its mesh with only the materials and images it uses.

#include <memory>

#include "protocol/animation.h"
#include "protocol/model.h"
#include "protocol/result.h"
#include "protocol/wire.h"

namespace mirage {

/// Self-contained: primitive.material indexes `materials`, texture images index `images`.
struct ObjectModel {
  Mesh mesh;
  std::vector<Material> materials;
  std::vector<Image> images;
  std::shared_ptr<const Animation> animation;  ///< set: the mesh is in bind space
};

/// Raw little-endian bytes (compressed by the sender).
Bytes encode_model(const ObjectModel& model);
/// Every count is checked against the bytes that are left and limits.h before allocating, every
/// index against its array, every float for being finite. Errors: kWireMalformed, kWireLimit,
/// kWireValue.
Result<ObjectModel> decode_model(const std::uint8_t* bytes, std::size_t size);

/// Bytes encode_model() would give, without making them.
std::size_t encoded_model_bytes(const ObjectModel& model);

}  // namespace mirage
