#pragma once
// The server's stages and what lies between them: everything behind the sessions.
//
//   sessions -> fetch stage -> sessions -> tile queue -> render stage -> encode stage -> sessions
//                                          image stage -> sessions
//
// Thread: start() and stop() are the owner's; the stages have threads of their own.

#include "server/stage/encode_stage.h"
#include "server/stage/fetch_stage.h"
#include "server/stage/image_stage.h"
#include "server/stage/render_stage.h"

namespace mirage {

class Pipeline {
 public:
  /// `wake` is called by any thread when there is a completion. `directory` nullptr: tiles are kept
  /// in memory only. Clock and directory outlive it.
  Pipeline(
      const Clock& clock, std::size_t cache_bytes, CacheDirectory* directory,
      std::function<void()> wake = [] {});
  ~Pipeline() { stop(); }

  /// Starts all threads and compiles every shader; the renderer's name. Errors: RenderStage's.
  Result<std::string> start(std::shared_ptr<const PreparedScene> scene,
                            const RenderOptions& options, int encoders);
  /// The queues close in flow order, then the threads end.
  void stop();

  StageQueues queues;

 private:
  FetchStage fetch_;
  RenderStage render_;
  EncodeStage encode_;
  ImageStage images_;
};

}  // namespace mirage
