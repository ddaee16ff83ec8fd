#pragma once
// Asynchronous read-back. A page is copied into a pixel-pack buffer behind a fence and collected
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
  int width = 0, height = 0;  ///< texels in use, from the lower left
  bool surface = false;       ///< also reads the third attachment
};

/// Returns the graphics memory of a page in read-back, bytes.
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
    /// Error kGraphicsGl: the pixels did not arrive, or the context failed and they are unusable.
    Result<std::shared_ptr<const PagePixels>> pixels;
  };
  /// Returns the oldest page. If `wait`, waits for its fence; else nullopt while it is under way.
  std::optional<Collected> collect(bool wait);

 private:
  struct Slot {
    PendingPage info;
    gl::Buffer color;
    gl::Buffer depth;
    gl::Buffer surface;  ///< if info.surface
    GLsync fence = nullptr;
  };
  static Result<std::shared_ptr<const PagePixels>> read(const Slot& slot);

  const std::size_t depth_;
  std::deque<Slot> slots_;
};

}  // namespace mirage
