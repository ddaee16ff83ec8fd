#include "client/hold/atlas_allocator.h"

#include <algorithm>

namespace mirage {
namespace {

constexpr int kGranularity = 8;

int round_up(int v, int step) { return (v + step - 1) / step * step; }

// Rounds up to one of a few heights, in steps of about 1.25, so that shelves can be reused.
int shelf_height(int h) {
  int height = 16;
  while (height < h) height = round_up(height + height / 4, kGranularity);
  return height;
}

}  // namespace

std::optional<int> AtlasAllocator::FreeList::take(int length) {
  for (auto it = free_.begin(); it != free_.end(); ++it) {
    if (it->second < length) continue;
    const int offset = it->first, left = it->second - length;
    free_.erase(it);
    if (left > 0) free_[offset + length] = left;
    return offset;
  }
  return std::nullopt;
}

void AtlasAllocator::FreeList::give(int offset, int length) {
  auto next = free_.lower_bound(offset);
  if (next != free_.end() && next->first == offset + length) {
    length += next->second;
    next = free_.erase(next);
  }
  if (next != free_.begin()) {
    const auto previous = std::prev(next);
    if (previous->first + previous->second == offset) {
      previous->second += length;
      return;
    }
  }
  free_[offset] = length;
}

AtlasAllocator::AtlasAllocator(int edge, int layers) : edge_(edge) {
  for (int i = 0; i < layers; ++i) layers_.push_back({FreeList(edge), {}});
}

std::size_t AtlasAllocator::footprint(int w, int h) const {
  const int width = std::min(round_up(w, kGranularity), edge_);
  const int height = std::min(shelf_height(h), edge_);
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

std::optional<AtlasSlot> AtlasAllocator::allocate(int w, int h) {
  if (w <= 0 || h <= 0 || w > edge_ || h > edge_) return std::nullopt;
  const int width = std::min(round_up(w, kGranularity), edge_);
  const int height = std::min(shelf_height(h), edge_);
  const auto made = [&](std::size_t layer, int x, int y) {
    used_texels_ += static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    return AtlasSlot{static_cast<int>(layer), x, y, w, h};
  };
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    for (auto& [y, shelf] : layers_[i].shelves) {
      if (shelf.height != height) continue;
      if (const std::optional<int> x = shelf.columns.take(width)) return made(i, *x, y);
    }
  }
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    if (const std::optional<int> y = layers_[i].rows.take(height)) {
      Shelf& shelf = layers_[i].shelves.emplace(*y, Shelf{height, FreeList(edge_)}).first->second;
      return made(i, *shelf.columns.take(width), *y);
    }
  }
  return std::nullopt;
}

void AtlasAllocator::release(const AtlasSlot& slot) {
  Layer& layer = layers_[static_cast<std::size_t>(slot.layer)];
  const auto at = layer.shelves.find(slot.y);
  if (at == layer.shelves.end()) return;
  const int width = std::min(round_up(slot.w, kGranularity), edge_), height = at->second.height;
  at->second.columns.give(slot.x, width);
  used_texels_ -= static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (at->second.columns.whole(edge_)) {
    layer.shelves.erase(at);
    layer.rows.give(slot.y, height);
  }
}

}  // namespace mirage
