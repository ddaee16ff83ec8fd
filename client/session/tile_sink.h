#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "client/frame/asset_id.h"
#include "protocol/codec/model_codec.h"
#include "protocol/model/model.h"

namespace mirage {

class SceneView;
struct ShadowRecord;
struct AtlasPlanes;
struct TileRecord;
struct ViewTile;

/// Tile sink: receives decoded pixels and meshes; the frame renderer implements it.
struct TileSink {
  std::function<void(const TileRecord&, const AtlasPlanes&)> tile;
  /// Receives AtlasPlanes::shadow of a shadow tile, or AtlasPlanes::depth of a caster.
  std::function<void(const ShadowRecord&, const std::vector<std::uint8_t>& plane)> shadow;
  std::function<void(std::uint32_t object, std::uint8_t lod, ObjectModel)> mesh;
  /// Receives a level of an image and its mip levels; none: the driver makes them.
  std::function<void(std::uint32_t index, const Image&, const std::vector<Image>& mips)> image;
  std::function<void(const AssetId&)> drop;  ///< a dropped image shows its mean colour again
  std::function<void(const SceneView&)> scene;
  std::function<void(const ViewTile&)> view;
};

}  // namespace mirage
