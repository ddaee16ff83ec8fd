#pragma once
// Tile cache: which tiles the client holds, for whom, and where in the atlas.
// Thread: the frame loop's.
// Full:   tiles drawn longest ago go first; a tile drawn in the current frame is never evicted, a
//         new one is then left out.

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "client/core/atlas_allocator.h"
#include "client/core/scene_view.h"
#include "protocol/capture.h"
#include "protocol/tile.h"

namespace mirage {

enum class DrawMethod : std::uint8_t { kQuad, kCuboid, kHull, kWarp, kDepth, kMesh };

/// A resident tile.
struct TileRecord {
  std::uint32_t object = 0;
  std::uint64_t serial = 0;  ///< order of arrival, unique
  Capture capture;
  TileCrop crop;
  TileMeasure measure;
  DepthCode depth_code{0, 1};
  AtlasSlot slot;
  std::vector<std::uint8_t> depth;  ///< codes of the crop, for the geometric error
  Phase phase = kStaticPhase;
  std::int64_t received_us = 0;
  std::uint64_t last_drawn = 0;  ///< frame number
  bool shown = false;            ///< drawn at least once
  std::size_t trace = SIZE_MAX;  ///< index of its life in the trace, if one is kept

  /// How far drawn points can be from the surface when drawn with `method`.
  DrawnDepth drawn_depth(DrawMethod method, const ObjectDescription& description) const;
  /// Bound in px of how far the object has moved since this pose.
  double motion_px(const ObjectDescription& description, const ViewGeometry& view) const;
  /// Bound in px: position, texel footprint, the sideways part of the level's error, and motion.
  double bound_px(DrawMethod method, const ObjectDescription& description,
                  const ViewGeometry& view) const;

 private:
  DrawnDepth drawn_depth_of_lod(DrawMethod method, const ObjectDescription& description) const;
};
using TileRecordPtr = std::shared_ptr<TileRecord>;

/// Tiles that look the same on every instance that shares them: same object, same light on it.
struct TileGroup {
  /// A view from which the object has no pixels: an empty tile came back.
  struct EmptyView {
    glm::dvec3 axis{0};  ///< unit, centre -> eye
    double cos_angle = 1;
  };
  std::vector<TileRecordPtr> tiles;
  std::vector<EmptyView> empty_views;

  /// Nothing of the object shows from `eye` (relative to its centre), as far as is known.
  bool empty_from(const glm::dvec3& eye) const;
  bool known() const { return !tiles.empty() || !empty_views.empty(); }
};

class TileCache {
 public:
  TileCache(int atlas_edge, int atlas_layers);

  /// Drops everything and learns the scene's instances.
  void reset(const SceneView& scene, const Lighting& lighting);
  /// New light: instances move to other groups and show their old tiles until new ones come.
  void relight(const SceneView& scene, const Lighting& lighting);

  /// Group to draw `instance` from: its own if it has tiles, else the one of the former light.
  const TileGroup* group_to_draw(std::uint32_t instance) const;
  /// Whether the group drawn is that of the present light.
  bool lit_now(std::uint32_t instance) const;

  /// Places a decoded tile into the atlas and its instance's group; nullptr when it is empty or no
  /// room can be made.
  TileRecordPtr insert(std::uint32_t instance, const SceneView& scene, const Capture& capture,
                       Tile tile, std::uint64_t frame, std::int64_t now_us,
                       Phase phase = kStaticPhase);

  std::size_t resident() const { return resident_; }
  std::size_t atlas_texels() const { return allocator_.used_texels(); }

 private:
  std::uint32_t group_of(const SceneView& scene, std::uint32_t instance, const Lighting& lighting);
  bool make_room(int w, int h, std::uint64_t frame, AtlasSlot& slot);
  bool evict_oldest(std::uint64_t frame);
  void forget(TileGroup& group, std::size_t index);
  void trim(TileGroup& group, std::uint64_t frame);

  AtlasAllocator allocator_;
  std::vector<TileGroup> groups_;
  std::unordered_map<std::uint64_t, std::uint32_t> group_index_;
  std::vector<std::uint32_t> instance_group_;
  std::vector<std::uint32_t> former_group_;
  std::uint64_t next_serial_ = 1;
  std::size_t resident_ = 0;
};

}  // namespace mirage
