#pragma once
// A scene that is served: what is loaded of it, the stages that draw it, and the sessions that look
// at it.

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
  /// Loads, prepares and uploads it; `cache` may be null. `wake` is called from any thread while
  /// this lives. Errors as load_scene(), RenderStage::start() and open_shared_store().
  static Result<std::unique_ptr<ServedScene>> start(const ServerOptions& options,
                                                    CacheDirectory* cache, const Clock& clock,
                                                    std::function<void()> wake);
  ~ServedScene();
  /// Ends the stages: what is asked for from now on does not come.
  void stop();

  const PreparedScene& scene() const;
  SessionHub& hub();
  StageQueues& queues();

 private:
  struct Parts;
  ServedScene();

  std::unique_ptr<Parts> parts_;
};

/// The options' scene, prepared as `keep_imported` asks; warnings and times go to the log.
Result<std::shared_ptr<const PreparedScene>> load_served(const ServerOptions& options,
                                                         CacheDirectory* cache);

}  // namespace mirage
