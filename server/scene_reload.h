#pragma once
// A scene whose file is replaced while it is served: it is said, and on a hangup it is loaded
// beside what is served, which then gives way to it.
// Thread: the network loop's; loading has one of its own.

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
  /// `path`: the scene's file, when it was loaded; what is no file is never another.
  SceneReload(std::string path, Load load);
  ~SceneReload() { end(); }
  /// Waits for what is under way, and lets go of it.
  void end();

  /// Loads it here and now.
  Result<std::unique_ptr<ServedScene>> load() const { return load_(); }
  /// Says once that the file is another than the one that is served. Several times a second.
  void look();
  /// Loads the file, if it is another; while one is being loaded, after that.
  void hangup();
  /// What is loaded and ready to be served, once.
  std::unique_ptr<ServedScene> take();
  /// Ends `old` without holding up the caller.
  void retire(std::unique_ptr<ServedScene> old);

 private:
  /// What tells one file from another that takes its place.
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
