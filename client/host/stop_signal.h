#pragma once
// Stop signal: Ctrl-C and SIGTERM end a program at its next frame, so that it still writes what it
// was asked for. Before its first frame there is nothing to write, and a signal ends it at once. So
// does a second signal, a second later or more.
// Thread: its own, which waits for the signals; the others never see them.

#include <atomic>
#include <functional>
#include <memory>

namespace mirage {

class StopSignal {
 public:
  /// Takes the signals over from now on, for the rest of the program. Threads that run already
  /// would still be ended by them, so it comes first. `stopped` is called on its thread at the
  /// first signal; it may be empty.
  explicit StopSignal(std::function<void()> stopped);

  /// Notes that the first frame begins.
  void begin_frames() const { state_->frames = true; }
  bool stopped() const { return state_->stopped; }

 private:
  struct State {
    std::atomic<bool> frames = false, stopped = false;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace mirage
