#pragma once
// Threads that share the work of loading a scene.

#include <cstddef>
#include <functional>
#include <memory>

namespace mirage {

/// Whoever waits works, so calls may nest: a loop over objects, in each of them loops over
/// vertices. What is written must depend on the index alone, not on who works or when.
class Workers {
 public:
  /// Nobody but the caller.
  Workers();
  /// `threads` counts the caller; 0: as many as the machine has cores.
  explicit Workers(std::size_t threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Calls `work` for each index below `count`, any of them at the same time, and comes back when
  /// all are done. `work` must not throw. Any thread.
  void each(std::size_t count, const std::function<void(std::size_t)>& work) const;
  /// The same of two pieces of work.
  void both(const std::function<void()>& one, const std::function<void()>& other) const;

 private:
  struct Pool;
  const std::unique_ptr<Pool> pool_;
};

}  // namespace mirage
