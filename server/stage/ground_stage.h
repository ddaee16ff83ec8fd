#pragma once
// Ground stage: makes blocks of the ground that people walk on.
// Input:  blocks asked for
// Output: encoded blocks, announced to the network loop
// Thread: one worker of its own (a block takes from a millisecond to a second)
// Full:   the network loop refuses the request as busy

#include <functional>
#include <memory>
#include <thread>

namespace mirage {

struct PreparedScene;
struct StageQueues;

class GroundStage {
 public:
  GroundStage(StageQueues& queues, std::function<void()> wake)
      : queues_(queues), wake_(std::move(wake)) {}
  ~GroundStage() { join(); }

  void start(std::shared_ptr<const PreparedScene> scene);
  /// Ends the worker; the input must be closed before.
  void join();

 private:
  StageQueues& queues_;
  std::function<void()> wake_;
  std::thread worker_;
};

}  // namespace mirage
