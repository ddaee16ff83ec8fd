#include "client/ask/catalogue.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/hold/mesh_cache.h"
#include "client/hold/tile_cache.h"
#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "wire_generated.h"

namespace mirage {
namespace {

// How much worse a tile looks, as an angle by which it could be off instead, radians.
constexpr double kCoarserClass = 0.06;  // a step coarser than needed
constexpr double kFinerClass = 0.01;    // a step finer
constexpr double kOtherKind = 0.5;      // a layered tile for a plain one, or the reverse

double off_by(const TileNeed& need, const glm::dvec3& direction, double log_distance,
              const glm::dvec3& entry_direction, double entry_log, int entry_class) {
  const double cosine = std::clamp(glm::dot(direction, entry_direction), -1.0, 1.0);
  const int finer = entry_class - need.size_class;
  return std::acos(cosine) + std::abs(entry_log - log_distance) +
         (finer < 0 ? -finer * kCoarserClass : finer * kFinerClass);
}

double log_radii(const DistanceBucket& bucket) {
  return std::log(radii_from_distance_bucket(bucket));
}

// True if a tile of the one instance shows the other as well.
bool looks_alike(const SceneView& scene, const TileCache& held, std::uint32_t instance,
                 std::uint32_t of_id, std::uint8_t channels) {
  if (scene.instances[instance].id == of_id) return true;
  if (channels == kShadowTile) return false;
  if (channels == kRelitTile || channels == kCasterTile) return true;
  const std::uint32_t other = scene.index_of(of_id);
  if (other == InstanceView::kNoParent) return false;
  const LightHistory& lights = held.lights();
  return lights.key(other, lights.current()) == lights.key(instance, lights.current());
}

bool same_use(std::uint8_t a, std::uint8_t b) { return a == b || (is_picture(a) && is_picture(b)); }

}  // namespace

void Catalogue::reset() { *this = Catalogue(); }

Result<void> Catalogue::accept_tile(const wire::FrozenTile& tile) {
  Entry entry{tile.instance(),
              {tile.view_level(), tile.view_x(), tile.view_y()},
              {tile.distance_level(), tile.distance_index()},
              tile.size_class(),
              tile.channels(),
              tile.phase(),
              {},
              0};
  const bool good = valid(entry.cell) && valid(entry.distance) && valid_channels(entry.channels) &&
                    entry.size_class <= limits::kMaxSizeClass;
  if (!good) return make_error(ErrorId::kWireValue, "tile of a folder that no key names");
  std::vector<Entry>& entries = tiles_[tile.object()];
  if (tile.bytes() == 0) {
    const auto same = [&](const Entry& e) {
      return e.instance == entry.instance && e.cell == entry.cell && e.distance == entry.distance &&
             e.size_class == entry.size_class && e.channels == entry.channels &&
             e.phase == entry.phase;
    };
    entries.erase(std::remove_if(entries.begin(), entries.end(), same), entries.end());
    return {};
  }
  entry.direction = direction_from_view_cell(entry.cell);
  entry.log_distance = log_radii(entry.distance);
  entries.push_back(entry);
  return {};
}

Result<void> Catalogue::accept(const wire::CatalogueT& page) {
  there_ = true;
  files_ += page.tiles.size() + page.assets.size();
  if (files_ > limits::kMaxFrozen) {
    return make_error(ErrorId::kWireLimit, "a folder of more files than a client takes");
  }
  for (const wire::FrozenTile& tile : page.tiles) {
    if (Result<void> taken = accept_tile(tile); !taken) return taken;
  }
  for (const wire::FrozenAsset& asset : page.assets) {
    const auto kind = asset.image() ? AssetId::Kind::kImage : AssetId::Kind::kMesh;
    std::set<std::uint8_t>& levels = levels_[{kind, asset.index()}];
    if (asset.bytes() > 0) {
      levels.insert(asset.level());
    } else {
      levels.erase(asset.level());
    }
  }
  return {};
}

const Catalogue::Entry* Catalogue::nearest(const SceneView& scene, const TileCache& held,
                                           const TileNeed& need) const {
  const auto at = tiles_.find(scene.object_id(need.instance));
  if (at == tiles_.end()) return nullptr;
  const glm::dvec3 direction = direction_from_view_cell(need.cell);
  const double log_distance = log_radii(need.distance);
  const Entry* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Entry& entry : at->second) {
    if (!same_use(entry.channels, need.channels) || entry.phase != need.phase) continue;
    const double off = off_by(need, direction, log_distance, entry.direction, entry.log_distance,
                              entry.size_class) +
                       (entry.channels == need.channels ? 0 : kOtherKind);
    if (off >= least || !looks_alike(scene, held, need.instance, entry.instance, entry.channels)) {
      continue;
    }
    least = off;
    best = &entry;
  }
  return best;
}

void Catalogue::fit(const SceneView& scene, const TileCache& held,
                    std::vector<TileNeed>& needs) const {
  if (!there_) return;
  const auto unmet = [&](TileNeed& need) {
    const Entry* const entry = nearest(scene, held, need);
    if (!entry) return true;
    need.cell = entry->cell;
    need.distance = entry->distance;
    need.size_class = entry->size_class;
    need.channels = entry->channels;
    if (!is_picture(need.channels)) return false;
    const double radius = scene.objects[scene.instances[need.instance].object].radius;
    const Capture capture(need.cell, need.distance, radius, tile_edge(need.size_class));
    return held.holds(need.instance, capture, need.channels == kRelitTile, need.phase, need.light);
  };
  needs.erase(std::remove_if(needs.begin(), needs.end(), unmet), needs.end());
}

void Catalogue::fit(const MeshCache& held, std::vector<AssetNeed>& needs) const {
  if (!there_) return;
  const auto unmet = [&](AssetNeed& need) {
    const auto at = levels_.find({need.id.kind, need.id.index});
    if (at == levels_.end() || at->second.empty()) return true;
    const std::set<std::uint8_t>& levels = at->second;
    // Level 0 is the finest of geometry, and the coarsest of an image.
    const bool rises = need.id.kind == AssetId::Kind::kImage;
    const auto up = levels.lower_bound(need.id.level);
    if (levels.count(need.id.level) == 0) {
      const bool none_above = up == levels.end(), none_below = up == levels.begin();
      need.id.level = none_above || (!rises && !none_below) ? *std::prev(up) : *up;
    }
    return held.resident(need.id);
  };
  needs.erase(std::remove_if(needs.begin(), needs.end(), unmet), needs.end());
}

}  // namespace mirage
