#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace mirage {

/// Shelf packing of square tiles into a page; tiles come in any order of sizes.
class PagePacker {
 public:
  struct Place {
    int x = 0, y = 0;
  };
  explicit PagePacker(int page_edge) : page_edge_(page_edge) {}

  int page_edge() const { return page_edge_; }
  const std::vector<Place>& places() const { return places_; }
  /// Returns the extent of the placed tiles, texels.
  const Place& used() const { return used_; }

  /// Places a tile; false if the page is full. A tile larger than the page gets a page of its own,
  /// which grows to its edge.
  bool add(std::uint32_t tile_edge) {
    const int edge = static_cast<int>(tile_edge);
    if (edge > page_edge_) {
      if (!places_.empty()) return false;
      page_edge_ = edge;
    }
    if (x_ + edge > page_edge_) {
      y_ += shelf_;
      x_ = shelf_ = 0;
    }
    if (y_ + edge > page_edge_) return false;
    places_.push_back({x_, y_});
    x_ += edge;
    used_ = {std::max(used_.x, x_), std::max(used_.y, y_ + edge)};
    shelf_ = std::max(shelf_, edge);
    return true;
  }

 private:
  int page_edge_;
  int x_ = 0, y_ = 0, shelf_ = 0;
  Place used_;
  std::vector<Place> places_;
};

}  // namespace mirage
