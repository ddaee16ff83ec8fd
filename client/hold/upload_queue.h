#pragma once
// Upload queue.
// Input:  messages as the link brings them. Output: those to take in now, so that what goes to the
//         graphics card in one frame stays within a budget, and no frame waits for a burst.
// Thread: the frame loop's.
// Full:   tiles, geometry and images beyond the budget wait, as they came, for the next frames:
//         first images of instances before others, then in order; one a frame is always taken. When
//         kMostWaiting wait, the rest is taken at once.

#include <cstdint>
#include <functional>
#include <vector>

#include "client/hold/upload_counts.h"
#include "protocol/wire/message.h"
namespace mirage {

/// Bytes a tile's window of w x h texels takes there; `channels` as of its key.
std::size_t tile_upload_bytes(std::size_t w, std::size_t h, std::uint8_t channels);

class UploadQueue {
 public:
  static constexpr std::size_t kMostWaiting = 4096;

  explicit UploadQueue(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

  /// Of a message, as far as it tells: what it brings to the graphics card; 0: nothing.
  using Cost = std::function<std::size_t(const Message&)>;
  /// It is a tile of an instance that shows nothing yet.
  using First = std::function<bool(const Message&)>;
  /// What is to be taken in now, of what has waited and what has just come, at `now_us`. Within the
  /// budget that is all, in order.
  std::vector<Message> take(std::vector<Message> arrived, std::int64_t now_us, const Cost& cost,
                            const First& first);
  /// What came over a connection that is gone.
  void clear() { waiting_.clear(); }
  bool empty() const { return waiting_.empty(); }

  /// Something has gone to the graphics card since the last take().
  void uploaded(std::size_t bytes, bool tile);
  const UploadCounts& counts() const { return counts_; }

 private:
  const std::size_t budget_bytes_;
  std::vector<Message> waiting_;
  std::int64_t taken_us_ = 0;
  std::uint64_t frame_bytes_ = 0;
  UploadCounts counts_;
};

}  // namespace mirage
