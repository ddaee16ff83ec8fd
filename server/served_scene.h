#pragma once
// A served scene: the loaded data, the stages that draw it, and the sessions of its viewers.

#include <functional>
#include <memory>

#include "protocol/base/result.h"

namespace mirage {

class CacheDirectory;
class Clock;
struct PreparedScene;
struct ServerOptions;
class SessionHub;
struct StageQueues;

class ServedScene {
 public:
  /// Loads, prepares and uploads the scene; `cache` may be null. The levels of detail follow on a
  /// thread of their own: until they are made, viewers get the home view alone. Any thread may call
  /// `wake` during the lifetime of this object. Errors as load_scene(), RenderStage::start() and
  /// open_shared_store().
  static Result<std::unique_ptr<ServedScene>> start(const ServerOptions& options,
                                                    CacheDirectory* cache, const Clock& clock,
                                                    std::function<void()> wake);
  ~ServedScene();
  /// Returns when the levels of detail are made. Not for use on several threads.
  void wait_for_levels();
  /// Ends the stages: later asks get no answer.
  void stop();

  const PreparedScene& scene() const;
  SessionHub& hub();
  StageQueues& queues();
  int encoders() const;

 private:
  struct Parts;
  ServedScene();

  std::unique_ptr<Parts> parts_;
};

/// Loads the options' scene, with its levels of detail. Warnings go to the log.
Result<std::shared_ptr<const PreparedScene>> load_served(const ServerOptions& options,
                                                         CacheDirectory* cache);

}  // namespace mirage
