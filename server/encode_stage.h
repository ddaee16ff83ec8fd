#pragma once
// Encode stage.
// Input:  rendered tiles (pixels of a page). Output: stored tiles, announced to the network loop.
// Thread: N workers of its own.
// Full:   the queue in front makes the render stage wait.

#include <thread>
#include <vector>

#include "protocol/bounded_queue.h"
#include "server/scene/prepared_scene.h"
#include "server/tile_job.h"
#include "server/tile_store.h"

namespace mirage {

class EncodeStage {
 public:
  EncodeStage(BoundedQueue<RenderedTile>& input, BoundedQueue<Completion>& completions,
              TileStore& store, std::function<void()> wake)
      : input_(input), completions_(completions), store_(store), wake_(std::move(wake)) {}
  ~EncodeStage() { join(); }

  void start(std::shared_ptr<const PreparedScene> scene, int workers, TileCodec codec);
  /// Ends the workers; the input must have been closed.
  void join();

  /// Cuts, measures and encodes one tile; a pure function of its input.
  static StoredTilePtr encode(const RenderedTile& tile, const ObjectDescription& object,
                              TileCodec codec);

 private:
  BoundedQueue<RenderedTile>& input_;
  BoundedQueue<Completion>& completions_;
  TileStore& store_;
  std::function<void()> wake_;
  std::vector<std::thread> workers_;
};

}  // namespace mirage
