#pragma once
// Shadow cache: resident shadow tiles (by instance and light) and caster tiles (by object), in an
// atlas of their own with one channel (TECHNIQUES row 7).
// Input:  shadow and caster tiles that arrive.
// Output: the tile captured nearest to a direction.
// Thread: the frame loop's.
// Full:   the tile used longest ago goes first. A tile used in the last two frames is never
//         evicted; a new tile is then left out.

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "client/frame/resident.h"
#include "client/hold/atlas_allocator.h"
#include "protocol/impostor/capture.h"
#include "protocol/impostor/tile.h"

namespace mirage {

/// A resident tile with one channel.
struct ShadowRecord {
  std::uint32_t light = 0;   ///< shadow tiles: serial of the lighting (LightHistory); else 0
  std::uint64_t serial = 0;  ///< order of arrival, unique
  Capture capture;
  TileCrop crop;  ///< empty: nothing shows from there
  DepthCode depth_code{0, 1};
  AtlasSlot slot;
  std::uint64_t last_used = 0;  ///< frame number
};

inline constexpr int kShadowAtlasEdge = 1024;
inline constexpr int kShadowAtlasLayers = 12;

class ShadowCache {
 public:
  void reset();

  /// Place a shadow tile of an instance, or a caster tile of an object. Return nullptr if no room
  /// can be made. An empty tile is kept as well, and takes no room.
  ShadowRecordPtr add_shadow(std::uint32_t instance, std::uint32_t light, const Capture& capture,
                             const TileCrop& crop, std::uint64_t frame);
  ShadowRecordPtr add_caster(std::uint32_t object, const Capture& capture, const TileCrop& crop,
                             std::uint64_t frame);

  /// Returns the shadow tile captured nearest to the direction `eye` (from the centre, object
  /// space) under this light; nullptr: none. Sets `angle` to the angle between both, radians.
  ShadowRecordPtr shadow(std::uint32_t instance, std::uint32_t light, const glm::dvec3& eye,
                         double& angle) const;
  /// Returns the caster tile captured nearest to `eye`, as shadow() does.
  ShadowRecordPtr caster(std::uint32_t object, const glm::dvec3& eye, double& angle) const;

  std::size_t resident() const { return resident_; }

 private:
  using Owned = std::unordered_map<std::uint32_t, std::vector<ShadowRecordPtr>>;
  ShadowRecordPtr place(std::vector<ShadowRecordPtr>& owned, const Capture& capture,
                        const TileCrop& crop, std::uint64_t frame);
  bool evict_oldest(std::uint64_t frame);
  void forget(std::vector<ShadowRecordPtr>& owned, std::size_t index);

  AtlasAllocator allocator_{kShadowAtlasEdge, kShadowAtlasLayers};
  Owned shadows_;  ///< by instance
  Owned casters_;  ///< by object
  std::uint64_t next_serial_ = 1;
  std::size_t resident_ = 0;
};

}  // namespace mirage
