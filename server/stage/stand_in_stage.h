#pragma once
// Stands in for the render stage in tests of many servers on a machine that could not render for
// all of them. It draws nothing: it sleeps for the time of a tile and hands on grey tiles. It
// refuses views and full renders.
// Input:  as of the render stage
// Output: grey tiles to the encode stage; refusals to the network loop
// Thread: its own, without GL
// Full:   as of the render stage

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

  /// Starts the thread and returns a renderer name. No real renderer has this name, so no cache
  /// mixes their tiles.
  std::string start(const RenderOptions& options);
  /// Ends the thread; the tile queue must be closed before.
  void join();

 private:
  void run(double tile_ms);

  StageQueues& queues_;
  std::function<void()> wake_;
  std::thread thread_;
};

}  // namespace mirage
