#pragma once
// Upload queue: spreads what goes to the graphics card over frames, so that no frame waits for a
// burst.
// Input:  messages as the link brings them.
// Output: the messages to take in now, within the budget of a frame.
// Thread: the frame loop's.
// Full:   tiles, geometry and images beyond the budget wait for the next frames. First images of
//         instances go before others, then the order of arrival counts. At least one is taken each
//         frame. When kMostWaiting wait, the rest is taken at once.

#include <cstdint>
#include <functional>
#include <vector>

#include "client/hold/upload_counts.h"
#include "protocol/wire/message.h"
namespace mirage {

/// Returns the bytes that a tile's window of w x h texels takes in graphics memory; `channels` as
/// in its key.
std::size_t tile_upload_bytes(std::size_t w, std::size_t h, std::uint8_t channels);

class UploadQueue {
 public:
  static constexpr std::size_t kMostWaiting = 4096;

  explicit UploadQueue(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

  /// Returns the bytes that a message brings to the graphics card, as far as it tells; 0: none.
  using Cost = std::function<std::size_t(const Message&)>;
  /// Returns true if the message is a tile of an instance that shows nothing yet.
  using First = std::function<bool(const Message&)>;
  /// Returns the messages to take in at `now_us`, from those that waited and those that just
  /// arrived. If they are within the budget, it returns all of them in order.
  std::vector<Message> take(std::vector<Message> arrived, std::int64_t now_us, const Cost& cost,
                            const First& first);
  /// Drops what waits, because its connection is gone.
  void clear() { waiting_.clear(); }
  bool empty() const { return waiting_.empty(); }

  /// Counts an upload to the graphics card since the last take().
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
