#pragma once
#include <cstdint>

namespace mirage {

/// Names one level of an object's geometry, or of an image.
struct AssetId {
  enum class Kind : std::uint8_t { kMesh, kImage };
  Kind kind = Kind::kMesh;
  std::uint32_t index = 0;  ///< index of the object or image
  std::uint8_t level = 0;   ///< meshes: 0 is the finest; images: 0 is the coarsest
  bool operator<(const AssetId& o) const {
    if (kind != o.kind) return kind < o.kind;
    return index != o.index ? index < o.index : level < o.level;
  }
  bool operator==(const AssetId& o) const {
    return kind == o.kind && index == o.index && level == o.level;
  }
};

}  // namespace mirage
