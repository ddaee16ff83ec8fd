#pragma once
// In the render stage's place, for trying many servers on a machine that could not render for all
// of them: it draws nothing, sleeps as long as a tile is to take, and hands on grey ones. Views and
// full renders there are none.
// Input, output, thread, full: as of the render stage, without GL.

#include <functional>
#include <string>
#include <thread>

namespace mirage {

struct RenderOptions;
struct StageQueues;

class StandInStage {
 public:
  StandInStage(StageQueues& queues, std::function<void()> wake);
  ~StandInStage();

  /// Its name, as a renderer's: other than any that draws, so that no cache mixes their tiles.
  std::string start(const RenderOptions& options);
  /// Ends the thread; the tile queue must have been closed.
  void join();

 private:
  void run(double tile_ms);

  StageQueues& queues_;
  std::function<void()> wake_;
  std::thread thread_;
};

}  // namespace mirage
