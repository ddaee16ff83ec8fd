#pragma once
// Tile cache: which tiles the client holds, for which instances, and where in the atlas.
// Input:  decoded tiles that arrive; the tiles drawn in each frame; the lighting.
// Output: the tiles to draw an instance from, and the room that is left.
// Thread: the frame loop's.
// Full:   the tile drawn longest ago goes first. A tile drawn in the current frame is never
//         evicted; a new tile is then left out. room() tells this in advance, so that the client
//         asks for coarser tiles, or for none.

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "client/frame/resident.h"
#include "client/hold/atlas_allocator.h"
#include "client/hold/light_history.h"
#include "protocol/impostor/capture.h"
#include "protocol/impostor/motion.h"
#include "protocol/impostor/tile.h"

namespace mirage {

struct ObjectDescription;
class SceneView;
struct ViewGeometry;

/// A resident tile.
struct TileRecord {
  std::uint32_t object = 0;
  std::uint64_t serial = 0;  ///< order of arrival, unique
  Capture capture;
  TileCrop crop;
  TileMeasure measure;
  DepthCode depth_code{0, 1};
  AtlasSlot slot;
  AtlasSlot front_slot, behind_slot;  ///< colours of both layers, and depth of the one behind
  /// Depth codes of the crop, for the geometric error. `behind_depth` is of the layer behind;
  /// empty: none.
  std::vector<std::uint8_t> depth, behind_depth;
  Phase phase = kStaticPhase;
  std::int64_t received_us = 0;
  std::uint64_t last_drawn = 0;  ///< frame number
  bool shown = false;            ///< drawn at least once
  bool relit = false;            ///< shaded when it is drawn

  bool layered() const { return !behind_depth.empty(); }
  /// Prepares the bounds. Call it once the captured values are set.
  void seal(const ObjectDescription& description);
  /// Returns the bound, px, of how far the object has moved since this pose.
  double motion_px(const ObjectDescription& description, const ViewGeometry& view) const;
  /// Returns the bound, px: position, texel footprint, sideways part of the level's error, and
  /// motion.
  double bound_px(DrawMethod method, const ObjectDescription& description,
                  const ViewGeometry& view) const;
  /// Returns the capture of the tile's whole window. Bounds use the smaller window of its content.
  const CaptureGeometry& whole() const { return whole_; }

 private:
  /// Return how far drawn points can be from the surface when drawn with `method`: with the error
  /// of the captured level, and without it.
  DrawnDepth drawn_depth(DrawMethod method, const ObjectDescription& description) const;
  DrawnDepth drawn_depth_of_lod(DrawMethod method, const ObjectDescription& description) const;

  CaptureGeometry whole_, content_;
  std::array<DrawnDepth, static_cast<std::size_t>(DrawMethod::kMesh)> drawn_;  // by method
};

/// Tiles that look the same on all instances that share them: same object, same light on it.
struct TileGroup {
  /// A view from which the object has no pixels: the server sent an empty tile.
  struct EmptyView {
    glm::dvec3 axis{0};  ///< unit vector from the centre to the eye
    double cos_angle = 1;
  };
  std::vector<TileRecordPtr> tiles;
  std::vector<EmptyView> empty_views;
  std::uint64_t turn = 0;  ///< turn of the latest lighting that wanted it (LightHistory)

  /// True if, as far as is known, nothing of the object shows from `eye` (relative to its centre).
  bool empty_from(const glm::dvec3& eye) const;
  bool known() const { return !tiles.empty() || !empty_views.empty(); }
};

class TileCache {
 public:
  TileCache(int atlas_edge, int atlas_layers);

  /// Drops everything and learns the scene's instances.
  void reset(const SceneView& scene, const Lighting& lighting);
  /// Learns the instances that have arrived since.
  void grow(const SceneView& scene) { lights_.grow(scene); }
  /// Sets a new light. Tiles of former lights are shown until newly lit ones arrive.
  void relight(const Lighting& lighting, std::int64_t now_us);
  /// Sets whether objects that can be relit want relit tiles (true) or lit ones (false).
  void want_relit(bool relit) { want_relit_ = relit; }
  bool wants_relit(std::uint32_t instance) const {
    return want_relit_ && lights_.can_relight(instance);
  }
  /// Returns the serial of the present lighting, for asks.
  std::uint32_t light() const { return lights_.current().serial; }

  /// The tiles that an instance can be drawn from.
  struct LitGroup {
    const TileGroup* tiles = nullptr;           ///< never null, possibly empty
    bool wanted = true;                         ///< they have the present light and the wanted kind
    const LightHistory::State* then = nullptr;  ///< their light, if it is not the present one
  };
  /// Returns relit tiles or those of the present light, the wanted kind first. If there are none,
  /// it returns those of the latest light that has some.
  LitGroup lit_group(std::uint32_t instance) const;
  const TileGroup* group_to_draw(std::uint32_t instance) const { return lit_group(instance).tiles; }
  const LightHistory& lights() const { return lights_; }

  /// Places a decoded tile into the atlas, and into the group of its instance under the light it
  /// was asked for (0: the present one). Returns nullptr if the tile is empty, if no room can be
  /// made, or if that light is no longer kept.
  TileRecordPtr insert(std::uint32_t instance, const SceneView& scene, const Capture& capture,
                       Tile tile, std::uint64_t frame, std::int64_t now_us, std::uint32_t light = 0,
                       Phase phase = kStaticPhase);

  /// Marks tiles as drawn in this frame: none of them is evicted in it or the next.
  void mark_drawn(const std::vector<TileRecordPtr>& tiles, std::uint64_t frame);

  /// True if the cache holds this very tile, so that asking for it brings nothing. `light` as for
  /// insert().
  bool holds(std::uint32_t instance, const Capture& capture, bool relit, Phase phase,
             std::uint32_t light) const;

  /// Room that a new tile can have without evicting what is in view.
  struct Room {
    std::size_t texels = SIZE_MAX;  ///< texels in all
    /// Part of them that is kept for instances that show nothing yet.
    std::size_t reserved = 0;
    std::uint32_t edge = UINT32_MAX;  ///< a tile of this edge, or a larger one, finds no place
  };
  Room room(std::uint64_t frame) const;
  /// Returns the texels that a tile of this edge takes, at most.
  std::size_t footprint(std::uint32_t edge) const;

  std::size_t resident() const { return owned_.size(); }
  std::size_t groups() const { return groups_.size(); }
  std::size_t atlas_texels() const { return allocator_.used_texels(); }

 private:
  const TileGroup* find(std::uint64_t key) const;
  /// Returns the texels of tiles that may not be evicted in this frame.
  std::size_t texels_in_view(std::uint64_t frame) const;
  void drop_past_groups();
  bool make_room(int w, int h, std::uint64_t frame, AtlasSlot& slot);
  bool make_room_for_layers(int w, int h, std::uint64_t frame, TileRecord& record);
  bool evict_oldest(std::uint64_t frame);
  void list_by_age();
  void forget(TileGroup& group, std::size_t index);
  void trim(TileGroup& group, std::uint64_t frame);

  AtlasAllocator allocator_;
  LightHistory lights_;
  bool want_relit_ = false;
  /// Groups by LightHistory::key, or by object for relit tiles. A group is made with its first
  /// tile.
  std::unordered_map<std::uint64_t, TileGroup> groups_;
  /// Same tiles by serial, as records that the cache may change.
  std::unordered_map<std::uint64_t, std::shared_ptr<TileRecord>> owned_;
  std::uint64_t next_serial_ = 1;
  /// Tiles in the order of eviction, the next one last; valid for the frame the list was made in.
  struct Aged {
    std::uint64_t last_drawn, serial, group;
  };
  std::vector<Aged> oldest_last_;
  std::uint64_t listed_at_ = UINT64_MAX;
  /// Edge of the last tile that found no place, and the texels in view then.
  std::uint32_t refused_edge_ = UINT32_MAX;
  std::size_t refused_at_texels_ = 0;
};

}  // namespace mirage
