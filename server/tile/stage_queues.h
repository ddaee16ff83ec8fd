#pragma once
// What lies between the server's stages and is shared by them: queues, the tile store, counters.

#include <atomic>

#include "protocol/base/bounded_queue.h"
#include "protocol/base/clock.h"
#include "server/base/counters.h"
#include "server/tile/tile_job.h"
#include "server/tile/tile_queue.h"
#include "server/tile/tile_store.h"

namespace mirage {

struct StageQueues {
  /// Clock and sources outlive it.
  StageQueues(const Clock& used_clock, std::size_t cache_bytes, TileSources sources)
      : clock(used_clock),
        store(cache_bytes, std::move(sources), counters),
        tiles(used_clock, counters) {}

  /// Nothing more is drawn: the encode stage ends.
  void close_drawn() {
    rendered.close();
    slow.close();
  }

  const Clock& clock;
  Counters counters;
  TileStore store;
  /// Since when the render stage is at what it does; 0: it waits for work.
  std::atomic<std::int64_t> rendering_since_us{0};
  BoundedQueue<FetchJob> fetches{4096};  ///< sessions -> fetch stage
  TileQueue tiles;                       ///< sessions -> render stage
  /// Render stage, sessions -> encode stage. Few enough that what is small waits behind little.
  BoundedQueue<EncodeJob> rendered{512, {pixel_bytes, 32u << 20}};
  BoundedQueue<EncodeJob> slow{1};             ///< the same of what takes long
  BoundedQueue<SaveJob> saves{256};            ///< encode stage -> fetch stage
  BoundedQueue<ImageLevel> images{4096};       ///< sessions -> image stage
  BoundedQueue<Completion> completions{8192};  ///< all stages -> sessions
};

}  // namespace mirage
