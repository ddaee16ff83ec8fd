#pragma once
// Image stage: reduces and encodes the scene's images.
// Input:  images asked for, by level
// Output: encoded images, announced to the network loop
// Thread: one worker of its own (an image takes from a millisecond to a second)
// Full:   the network loop refuses the ask as busy

#include <functional>
#include <memory>
#include <thread>

#include "protocol/base/bytes.h"

namespace mirage {

struct ImageLevel;
struct StageQueues;

struct PreparedScene;

class ImageStage {
 public:
  ImageStage(StageQueues& queues, std::function<void()> wake)
      : queues_(queues), wake_(std::move(wake)) {}
  ~ImageStage() { join(); }

  void start(std::shared_ptr<const PreparedScene> scene);
  /// Ends the worker; the input must be closed before.
  void join();

  /// Reduces and encodes one level; empty if that fails. A pure function.
  static Bytes encode(const PreparedScene& scene, const ImageLevel& level);

 private:
  StageQueues& queues_;
  std::function<void()> wake_;
  std::thread worker_;
};

}  // namespace mirage
