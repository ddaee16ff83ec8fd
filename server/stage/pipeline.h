#pragma once
// The server's stages and the queues between them: everything behind the sessions.
//
//   sessions -> fetch stage -> sessions -> tile queue -> render stage -> encode stage -> sessions
//                                          image stage -> sessions
//
// Thread: the owner calls start() and stop(); the stages have threads of their own.

#include <functional>
#include <memory>
#include <string>

#include "protocol/base/result.h"
#include "server/tile/stage_queues.h"

namespace mirage {

struct PreparedScene;
struct RenderOptions;

class Pipeline {
 public:
  /// Any thread calls `wake` when there is a completion. Clock and sources must outlive the
  /// pipeline.
  Pipeline(
      const Clock& clock, std::size_t cache_bytes, TileSources sources,
      std::function<void()> wake = [] {});
  ~Pipeline();

  /// Starts all threads and compiles every shader. `encoders`: 0 for as many as suit the machine.
  /// Returns the renderer's name. Errors: RenderStage's.
  Result<std::string> start(std::shared_ptr<const PreparedScene> scene,
                            const RenderOptions& options, int encoders);
  int encoders() const { return encoders_; }  ///< of a started pipeline
  /// Closes the queues in flow order, then ends the threads.
  void stop();

  StageQueues queues;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
  int encoders_ = 0;
};

}  // namespace mirage
