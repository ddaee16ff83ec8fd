#include "client/hold/shadow_cache.h"

#include <algorithm>

#include "protocol/base/stable_math.h"

namespace mirage {
namespace {

constexpr std::size_t kMaxShadowsPerInstance = 6;  // enough for lights that return, and for views
constexpr int kShadowGutter = 1;                   // texels

ShadowRecordPtr nearest(const std::vector<ShadowRecordPtr>& owned, std::uint32_t light,
                        const glm::dvec3& eye, double& angle) {
  ShadowRecordPtr best;
  for (const ShadowRecordPtr& record : owned) {
    if (record->light != light) continue;
    const double off = angle_between(record->capture.eye(), eye);
    // Two tiles may be equally near; the later one may be sharper.
    if (best && off > angle) continue;
    best = record;
    angle = off;
  }
  return best;
}

}  // namespace

void ShadowCache::reset() {
  for (Owned* kind : {&shadows_, &casters_}) {
    for (auto& [owner, owned] : *kind) {
      while (!owned.empty()) forget(owned, owned.size() - 1);
    }
    kind->clear();
  }
}

ShadowRecordPtr ShadowCache::add_shadow(std::uint32_t instance, std::uint32_t light,
                                        const Capture& capture, const TileCrop& crop,
                                        std::uint64_t frame) {
  std::vector<ShadowRecordPtr>& owned = shadows_[instance];
  ShadowRecordPtr record = place(owned, capture, crop, frame);
  if (!record) return nullptr;
  record->light = light;
  if (owned.size() > kMaxShadowsPerInstance) {
    const auto oldest = std::min_element(owned.begin(), owned.end() - 1,
                                         [](const ShadowRecordPtr& a, const ShadowRecordPtr& b) {
                                           return a->last_used < b->last_used;
                                         });
    forget(owned, static_cast<std::size_t>(oldest - owned.begin()));
  }
  return record;
}

ShadowRecordPtr ShadowCache::add_caster(std::uint32_t object, const Capture& capture,
                                        const TileCrop& crop, std::uint64_t frame) {
  return place(casters_[object], capture, crop, frame);
}

ShadowRecordPtr ShadowCache::shadow(std::uint32_t instance, std::uint32_t light,
                                    const glm::dvec3& eye, double& angle) const {
  const auto at = shadows_.find(instance);
  return at == shadows_.end() ? nullptr : nearest(at->second, light, eye, angle);
}

ShadowRecordPtr ShadowCache::caster(std::uint32_t object, const glm::dvec3& eye,
                                    double& angle) const {
  const auto at = casters_.find(object);
  return at == casters_.end() ? nullptr : nearest(at->second, 0, eye, angle);
}

ShadowRecordPtr ShadowCache::place(std::vector<ShadowRecordPtr>& owned, const Capture& capture,
                                   const TileCrop& crop, std::uint64_t frame) {
  auto record = std::make_shared<ShadowRecord>();
  const int w = static_cast<int>(crop.w) + 2 * kShadowGutter,
            h = static_cast<int>(crop.h) + 2 * kShadowGutter;
  if (w > kShadowAtlasEdge || h > kShadowAtlasEdge) return nullptr;
  while (crop.area() > 0) {
    if (const std::optional<AtlasSlot> found = allocator_.allocate(w, h)) {
      record->slot = *found;
      break;
    }
    if (!evict_oldest(frame)) return nullptr;
  }
  record->serial = next_serial_++;
  record->capture = capture;
  record->crop = crop;
  record->depth_code = DepthCode(capture.radius, capture.distance);
  record->last_used = frame;
  owned.push_back(record);
  ++resident_;
  return record;
}

bool ShadowCache::evict_oldest(std::uint64_t frame) {
  std::vector<ShadowRecordPtr>* from = nullptr;
  std::size_t index = 0;
  for (Owned* kind : {&shadows_, &casters_}) {
    for (auto& [owner, owned] : *kind) {
      for (std::size_t i = 0; i < owned.size(); ++i) {
        const ShadowRecord& record = *owned[i];
        if (record.crop.area() == 0 || record.last_used + 1 >= frame) continue;
        // Equally old tiles: the one that arrived earlier goes first, whatever the order of the
        // owners.
        const ShadowRecord* oldest = from ? (*from)[index].get() : nullptr;
        if (oldest && (record.last_used > oldest->last_used ||
                       (record.last_used == oldest->last_used && record.serial > oldest->serial))) {
          continue;
        }
        from = &owned;
        index = i;
      }
    }
  }
  if (!from) return false;
  forget(*from, index);
  return true;
}

void ShadowCache::forget(std::vector<ShadowRecordPtr>& owned, std::size_t index) {
  if (owned[index]->crop.area() > 0) allocator_.release(owned[index]->slot);
  owned.erase(owned.begin() + static_cast<std::ptrdiff_t>(index));
  --resident_;
}

}  // namespace mirage
