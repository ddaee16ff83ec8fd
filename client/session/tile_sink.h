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
struct TilePixels;
struct TileRecord;
struct ViewTile;

/// Tile sink: receives decoded pixels and meshes; the frame renderer implements it.
struct TileSink {
  std::function<void(const TileRecord&, const TilePixels&)> tile;
  std::function<void(const ShadowRecord&, const std::vector<std::uint8_t>&)> shadow, caster;
  std::function<void(std::uint32_t object, std::uint8_t lod, ObjectModel)> mesh;
  std::function<void(std::uint32_t index, const Image&)> image;
  std::function<void(const AssetId&)> drop;  ///< a dropped image shows its mean colour again
  std::function<void(const SceneView&)> scene;
  std::function<void(const ViewTile&)> view;
};

}  // namespace mirage
