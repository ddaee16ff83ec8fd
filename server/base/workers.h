#pragma once
// Threads that share the work of loading a scene.

#include <cstddef>
#include <functional>
#include <memory>

namespace mirage {

/// Runs loops on several threads. A caller works while it waits, so calls may nest: a loop over
/// objects may run loops over vertices. Results must depend on the index alone, not on the thread
/// or the time.
class Workers {
 public:
  /// Makes a pool without threads: the caller does all the work.
  Workers();
  /// Starts a pool of `threads` threads, the caller included; 0: one per core of the machine.
  explicit Workers(std::size_t threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Calls `work` for each index below `count`, in parallel and in any order, and returns when all
  /// calls are done. `work` must not throw. Any thread.
  void each(std::size_t count, const std::function<void(std::size_t)>& work) const;
  /// Runs two pieces of work in parallel and returns when both are done.
  void both(const std::function<void()>& one, const std::function<void()>& other) const;

 private:
  struct Pool;
  const std::unique_ptr<Pool> pool_;
};

}  // namespace mirage
