#pragma once
// Asynchronous read-back: a page is copied into a pixel-pack buffer behind a fence and collected
// later, so drawing the next page never waits for the copy. GL thread only.

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "protocol/base/result.h"
#include "server/tile/tile_job.h"
#include "shaders/gl/render_target.h"

namespace mirage {

struct PendingPage {
  std::vector<TileJob> jobs;
  std::vector<std::pair<int, int>> places;
  std::int64_t started_us = 0;
  int width = 0, height = 0;  ///< texels that the tiles take up, from the lower left
  bool surface = false;       ///< read the third attachment, too
};

/// Graphics memory of a page on its way back, bytes.
inline std::size_t readback_bytes(int width, int height, bool surface) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * (surface ? 9 : 5);
}

class ReadbackRing {
 public:
  explicit ReadbackRing(std::size_t depth) : depth_(depth) {}
  ~ReadbackRing();

  bool full() const { return slots_.size() >= depth_; }
  bool empty() const { return slots_.empty(); }
  void start(const gl::RenderTarget& page, PendingPage info);
  std::size_t gpu_bytes() const {
    std::size_t bytes = 0;
    for (const Slot& slot : slots_) {
      bytes += readback_bytes(slot.info.width, slot.info.height, slot.info.surface);
    }
    return bytes;
  }

  struct Collected {
    PendingPage info;
    /// Error kGraphicsGl: they did not arrive, or the context failed meanwhile; what was read of
    /// them is worth nothing.
    Result<std::shared_ptr<const PagePixels>> pixels;
  };
  /// The oldest page: waits for its fence if `wait`, else gives nothing while it is under way.
  std::optional<Collected> collect(bool wait);

 private:
  struct Slot {
    PendingPage info;
    gl::Buffer color;
    gl::Buffer depth;
    gl::Buffer surface;  ///< where info.surface says so
    GLsync fence = nullptr;
  };
  static Result<std::shared_ptr<const PagePixels>> read(const Slot& slot);

  const std::size_t depth_;
  std::deque<Slot> slots_;
};

}  // namespace mirage
