#pragma once
// Shared state between the server's stages: queues, the tile store, counters.

#include <atomic>

#include "protocol/base/bounded_queue.h"
#include "protocol/base/clock.h"
#include "server/base/counters.h"
#include "server/tile/tile_job.h"
#include "server/tile/tile_queue.h"
#include "server/tile/tile_store.h"

namespace mirage {

struct StageQueues {
  /// Clock and sources must outlive the queues.
  StageQueues(const Clock& used_clock, std::size_t cache_bytes, TileSources sources)
      : clock(used_clock),
        store(cache_bytes, std::move(sources), counters),
        tiles(used_clock, counters) {}

  /// Ends the encode stage: no more is drawn.
  void close_drawn() {
    rendered.close();
    slow.close();
  }

  const Clock& clock;
  Counters counters;
  TileStore store;
  /// Start of the render stage's present work, µs; 0: it waits for work.
  std::atomic<std::int64_t> rendering_since_us{0};
  BoundedQueue<FetchJob> fetches{4096};  ///< sessions -> fetch stage
  TileQueue tiles;                       ///< sessions -> render stage
  /// Render stage, sessions -> encode stage. It is short, so that small jobs wait behind few
  /// others.
  BoundedQueue<EncodeJob> rendered{512, {pixel_bytes, 32u << 20}};
  BoundedQueue<EncodeJob> slow{1};             ///< render stage -> encode stage, slow work
  BoundedQueue<SaveJob> saves{256};            ///< encode stage -> fetch stage
  BoundedQueue<ImageLevel> images{4096};       ///< sessions -> image stage
  BoundedQueue<GroundBlockId> grounds{256};    ///< sessions -> ground stage
  BoundedQueue<Completion> completions{8192};  ///< all stages -> sessions
};

}  // namespace mirage
