#pragma once
// Shadow stage: the sun's shadows on impostors and geometry.
// Input:  the draw list, the light, shadow and caster tiles that arrive.
// Output: the shadow tile of each drawn impostor, the casters of the shadow map, and what to ask
//         for.
// Thread: the frame loop's.
// Full:   never; the cache behind it may be (shadow_cache.h).
//
// Impostors wear the shadow tile of their instance. Geometry is shadowed by a map, drawn from
// meshes and from tiles captured along the light. Only the sun casts (sun_of). While it turns, the
// map follows, and impostors are drawn without shadows, because their tiles would always come late.

#include <map>
#include <tuple>
#include <vector>

#include "client/frame/caster_list.h"
#include "client/hold/shadow_cache.h"
#include "client/plan/tile_need.h"
namespace mirage {

struct DrawList;
struct DrawnImpostor;
struct Lighting;
class MeshCache;
struct SelectorInput;

class ShadowStage {
 public:
  void reset();
  /// Notes a change of the light.
  void relight(std::int64_t now_us) { light_since_us_ = now_us; }
  /// Notes that a mesh or image has arrived: the next map is drawn with it.
  void assets_changed() { ++assets_; }
  /// Keeps a shadow or caster tile; nullptr if there is no room for it.
  ShadowRecordPtr insert(const TileNeed& need, std::uint32_t object, const Capture& capture,
                         const TileCrop& crop, std::uint64_t frame);

  /// Adds shadow tiles and casters under `lighting` to the draw list. `meshes` chooses the levels
  /// of casters.
  void shade(const SelectorInput& in, const Lighting& lighting, MeshCache& meshes, DrawList& list);
  /// Adds what is worth asking for when `list` is drawn.
  void add_needs(const SelectorInput& in, const Lighting& lighting, const DrawList& list,
                 std::vector<TileNeed>& needs) const;

 private:
  struct CasterWalk;
  void walk_casters(CasterWalk& walk, std::uint32_t instance) const;
  void add_shadow_need(const SelectorInput& in, const Lighting& lighting,
                       const DrawnImpostor& drawn, std::vector<TileNeed>& needs) const;

  ShadowCache cache_;
  CasterListPtr casters_;
  std::vector<TileNeed> caster_needs_;  ///< needs of the last walk
  std::int64_t walked_us_ = INT64_MIN / 2;
  std::int64_t light_since_us_ = INT64_MIN / 2;
  std::uint64_t assets_ = 0;
};

}  // namespace mirage
