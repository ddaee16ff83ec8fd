#pragma once
// Replacement of the scene while it is served. A changed file is reported in the log. A hangup
// signal loads it beside the served scene, which it then replaces.
// Thread: the network loop's; loading has a thread of its own.

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "protocol/base/result.h"

namespace mirage {

class ServedScene;

class SceneReload {
 public:
  using Load = std::function<Result<std::unique_ptr<ServedScene>>()>;
  /// `path`: the scene's file, compared with its state when it was loaded. A built-in scene never
  /// changes.
  SceneReload(std::string path, Load load);
  ~SceneReload() { end(); }
  /// Waits for a load under way and drops its scene.
  void end();

  /// Loads the scene on the calling thread.
  Result<std::unique_ptr<ServedScene>> load() const { return load_(); }
  /// Logs once that the file differs from the served one. Called several times a second.
  void look();
  /// Loads the file if it changed; if a load is under way, loads again after it.
  void hangup();
  /// Returns a loaded scene, ready to be served, once; nullptr: none.
  std::unique_ptr<ServedScene> take();
  /// Ends `old` without blocking the caller.
  void retire(std::unique_ptr<ServedScene> old);

 private:
  /// Distinguishes a file from another that takes its place.
  struct Stamp {
    std::uint64_t inode = 0, bytes = 0;
    std::int64_t changed_ns = 0;
    bool operator==(const Stamp&) const = default;
  };
  std::optional<Stamp> stamp() const;

  const std::string path_;
  const Load load_;
  std::optional<Stamp> served_, told_;
  std::thread loading_, retiring_;
  std::atomic<bool> loaded_{false};
  bool under_way_ = false, again_ = false;
  std::unique_ptr<ServedScene> next_;
};

}  // namespace mirage
