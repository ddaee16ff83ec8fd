#pragma once
// Encode stage: rendered pixels become encoded tiles, views and replies.
// Input:  rendered tiles (pixels of a page), tiles wanted in another form, drawn views and full
//         renders
// Output: stored tiles, encoded views and replies, announced to the network loop
// Thread: N workers of its own, and one for slow work, which runs at lower priority
// Full:   the queue in front makes the render stage wait

#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "server/tile/tile_job.h"

namespace mirage {

struct StageQueues;

struct PreparedScene;
struct ObjectDescription;

class EncodeStage {
 public:
  EncodeStage(StageQueues& queues, std::function<void()> wake)
      : queues_(queues), wake_(std::move(wake)) {}
  ~EncodeStage() { join(); }

  void start(std::shared_ptr<const PreparedScene> scene, int workers);
  /// Ends the workers; the input must be closed before.
  void join();

 private:
  /// Finishes a job, or refuses it if memory is short.
  void work(EncodeJob& job, const PreparedScene& scene);
  void refuse(const EncodeJob& job);
  void finish(const RenderedTile& rendered, const ObjectDescription& object);
  void finish(const FormJob& job);
  void finish(const RenderedView& drawn);
  void finish(RenderedReference& drawn);
  void finish(EncodeJob& job, const PreparedScene& scene);
  void announce(Completion done);

  /// Passes a tile to the fetch stage to be kept, unless there are no sources or too many writes
  /// wait.
  void save(const TileId& id, TileCodec codec, StoredTilePtr tile);

  StageQueues& queues_;
  std::function<void()> wake_;
  std::vector<std::thread> workers_;
};

}  // namespace mirage
