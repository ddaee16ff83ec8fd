#pragma once
// The server's stages and what lies between them: everything behind the sessions.
//
//   sessions -> fetch stage -> sessions -> tile queue -> render stage -> encode stage -> sessions
//                                          image stage -> sessions
//
// Thread: start() and stop() are the owner's; the stages have threads of their own.

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
  /// `wake` is called by any thread when there is a completion. Clock and sources outlive it.
  Pipeline(
      const Clock& clock, std::size_t cache_bytes, TileSources sources,
      std::function<void()> wake = [] {});
  ~Pipeline();

  /// Starts all threads and compiles every shader; the renderer's name. Errors: RenderStage's.
  Result<std::string> start(std::shared_ptr<const PreparedScene> scene,
                            const RenderOptions& options, int encoders);
  /// The queues close in flow order, then the threads end.
  void stop();

  StageQueues queues;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace mirage
