#pragma once
// Atlas allocator: hands out rectangles in the layers of the atlas. A layer has shelves of a few
// heights, and each shelf a list of free intervals.

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace mirage {

struct AtlasSlot {
  int layer = 0, x = 0, y = 0;
  int w = 0, h = 0;  ///< size asked for; the slot itself is rounded up
};

class AtlasAllocator {
 public:
  /// Makes `layers` layers of `edge` x `edge` texels.
  AtlasAllocator(int edge, int layers);

  /// Returns a free slot; nullopt if there is no room, or if w or h exceeds the layer.
  std::optional<AtlasSlot> allocate(int w, int h);
  void release(const AtlasSlot& slot);

  /// Returns the texels that a slot of this size takes, with rounding.
  std::size_t footprint(int w, int h) const;
  int edge() const { return edge_; }
  int layers() const { return static_cast<int>(layers_.size()); }
  std::size_t used_texels() const { return used_texels_; }

 private:
  /// Free intervals by offset; neighbours are joined on release.
  class FreeList {
   public:
    explicit FreeList(int length) { free_[0] = length; }
    std::optional<int> take(int length);
    void give(int offset, int length);
    bool whole(int length) const { return free_.size() == 1 && free_.begin()->second == length; }

   private:
    std::map<int, int> free_;
  };
  struct Shelf {
    int height = 0;
    FreeList columns;
  };
  struct Layer {
    FreeList rows;
    std::map<int, Shelf> shelves;  ///< by y
  };

  const int edge_;
  std::vector<Layer> layers_;
  std::size_t used_texels_ = 0;
};

}  // namespace mirage
