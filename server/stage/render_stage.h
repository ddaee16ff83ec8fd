#pragma once
// Render stage.
// Input:  batches and reference jobs from the tile queue. Output: rendered tiles to the encode
//         stage, whole reference replies to the network loop.
// Thread: its own, the only one with the GL context.
// Full:   waits (the encode queue is bounded), so the tile queue in front fills and refuses.

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "server/prepare/prepared_scene.h"
#include "server/tile/stage_queues.h"

namespace mirage {

struct RenderOptions {
  std::string device = "auto";
  int page_edge = 512;        ///< texels; larger pages suit a GPU
  int supersample = 2;        ///< per axis
  std::size_t ring = 2;       ///< pages in flight between drawing and read-back
  std::size_t gpu_mb = 4096;  ///< graphics memory for the scene, targets and the ring, at most
  bool shadows = false;       ///< the sun's, in reference frames and shadow tiles
};

class RenderStage {
 public:
  RenderStage(StageQueues& queues, std::function<void()> wake);
  ~RenderStage();

  /// Starts the thread, uploads the scene and compiles every shader; returns the renderer's name.
  /// Errors: kGraphicsDevice, kGraphicsShader, kGraphicsGl (also: over the budget).
  Result<std::string> start(std::shared_ptr<const PreparedScene> scene,
                            const RenderOptions& options);
  /// Ends the thread; the tile queue must have been closed.
  void join();

 private:
  void run(std::shared_ptr<const PreparedScene> scene, RenderOptions options,
           std::function<void(Result<std::string>)> ready);

  StageQueues& queues_;
  std::function<void()> wake_;
  std::thread thread_;
};

}  // namespace mirage
