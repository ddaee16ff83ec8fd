#pragma once
// Render stage: draws tiles, views and full renders.
// Input:  batches of tiles, views and full renders from the tile queue
// Output: rendered tiles and pictures to the encode stage; refusals to the network loop
// Thread: its own, the only one with the GL context
// Full:   waits (the encode queue is bounded), so the tile queue in front fills and refuses

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "protocol/base/result.h"

namespace mirage {

struct RenderOptions;
struct StageQueues;

struct PreparedScene;

/// The renderer in use.
struct Renderer {
  std::string name;      ///< with its driver
  bool software = true;  ///< it draws on the processor
};

class RenderStage {
 public:
  RenderStage(StageQueues& queues, std::function<void()> wake);
  ~RenderStage();

  /// Starts the thread, uploads the scene and compiles every shader. Errors: kGraphicsDevice,
  /// kGraphicsShader, kGraphicsGl (also: over the memory budget).
  Result<Renderer> start(std::shared_ptr<const PreparedScene> scene, const RenderOptions& options);
  /// Ends the thread; the tile queue must be closed before.
  void join();

 private:
  void run(std::shared_ptr<const PreparedScene> scene, RenderOptions options,
           std::function<void(Result<Renderer>)> ready);

  StageQueues& queues_;
  std::function<void()> wake_;
  std::thread thread_;
};

}  // namespace mirage
