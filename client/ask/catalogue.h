#pragma once
// Catalogue: the files of a frozen folder, beside which nothing can be asked for.
// Input:  the folder's pages; needs of a frame.
// Output: the needs that the folder can meet, each as the nearest file.
// Thread: the frame loop's.
// Full:   it refuses pages beyond limits::kMaxFrozen.
//
// The bound says how wrong the nearest file looks, so it is drawn like any other stale tile. A
// server's client has no catalogue and asks for what it needs.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "client/hold/asset_need.h"
#include "client/plan/tile_need.h"
#include "protocol/base/result.h"

namespace mirage {

class MeshCache;
class SceneView;
class TileCache;
namespace wire {
struct CatalogueT;
struct FrozenTile;
}  // namespace wire

class Catalogue {
 public:
  /// Forgets the folder, for a new connection.
  void reset();
  /// Takes a page. A file without bytes is one that turned out to be missing: it is forgotten.
  /// Errors kWireLimit, kWireValue.
  Result<void> accept(const wire::CatalogueT& page);
  /// True if the other side is a frozen folder.
  bool there() const { return there_; }

  /// Turns each need into the nearest tile that the folder has of its instance. Removes needs of
  /// which it has none, and those whose nearest tile is held.
  void fit(const SceneView& scene, const TileCache& held, std::vector<TileNeed>& needs) const;
  /// Fits needs of geometry and images: to the nearest finer level, or else the nearest coarser
  /// one.
  void fit(const MeshCache& held, std::vector<AssetNeed>& needs) const;

 private:
  struct Entry {
    std::uint32_t instance = 0;  ///< the server's id
    ViewCell cell;
    DistanceBucket distance;
    std::uint8_t size_class = 0, channels = 0;
    Phase phase = kStaticPhase;
    glm::dvec3 direction{0};  ///< to the eye, at the middle of the cell
    double log_distance = 0;  ///< ln of the distance in radii
  };
  Result<void> accept_tile(const wire::FrozenTile& tile);
  const Entry* nearest(const SceneView& scene, const TileCache& held, const TileNeed& need) const;

  bool there_ = false;
  std::size_t files_ = 0;
  std::unordered_map<std::uint32_t, std::vector<Entry>> tiles_;  ///< by the server's object
  std::map<std::pair<AssetId::Kind, std::uint32_t>, std::set<std::uint8_t>> levels_;
};

}  // namespace mirage
