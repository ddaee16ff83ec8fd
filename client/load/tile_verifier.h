#pragma once
// Tile verifier: decodes tiles completely in a thread of its own during the run.
// Input:  copies of tile replies.
// Output: how many were decoded in full, how many failed, and why.
// Thread: its own, at the lowest priority, so that checking does not slow what is measured.
// Full:   the tile is not verified; `verified` counts only those that were.

#include <atomic>
#include <string>
#include <thread>

#include "protocol/base/bounded_queue.h"
#include "protocol/wire/message.h"

namespace mirage {

struct VerifyTask {
  wire::TileReplyT reply;
  Bytes planes;
};

/// Decodes the tile in full and checks it: planes fit the crop within the window, their hash is the
/// announced one, and texels without coverage have no colour. Errors: kCodec, kWireValue,
/// kComparison.
Result<void> verify_tile(const VerifyTask& task);

class TileVerifier {
 public:
  TileVerifier();
  ~TileVerifier() { finish(); }

  void submit(VerifyTask task) { tasks_.try_push(task); }
  /// Checks what is still waiting; after it, the figures below no longer change.
  void finish();

  std::uint64_t verified() const { return verified_; }
  std::uint64_t failures() const { return failures_; }
  /// Returns the first failure's error line; valid after finish().
  const std::string& first_failure() const { return first_failure_; }

 private:
  void run();

  BoundedQueue<VerifyTask> tasks_;
  std::atomic<std::uint64_t> verified_{0}, failures_{0};
  std::string first_failure_;
  std::thread thread_;
};

}  // namespace mirage
