#pragma once
// Fetch stage: all access to the sources of finished tiles.
// Input:  tiles to look for; tiles to be kept
// Output: found tiles, announced to the network loop
// Thread: readers, one that looks again for tiles that another server renders, and a writer, so
//         a source that takes seconds blocks no other thread
// Full:   an ask skips the sources and is rendered; a finished tile is not kept

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "server/tile/tile_job.h"

namespace mirage {

struct StageQueues;

class FetchStage {
 public:
  FetchStage(StageQueues& queues, std::function<void()> wake)
      : queues_(queues), wake_(std::move(wake)) {}
  ~FetchStage() { join(); }

  /// Starts the threads; none if there are no sources.
  void start();
  /// Ends the threads; both inputs must be closed before. Writes that take longer than two seconds
  /// in all are dropped.
  void join();

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Again {
    FetchJob job;
    std::chrono::milliseconds pause;  ///< wait after the next look, if that fails, too
  };

  void read_all();
  void look_again();
  void write_all();
  /// Announces the result of a look; an empty result means that this server must render the tile.
  /// False: another server is rendering it.
  bool look(const FetchJob& job);
  /// Schedules another look; false: too many are scheduled.
  bool look_later(const FetchJob& job, std::chrono::milliseconds pause);
  void announce(Completion done);

  StageQueues& queues_;
  std::function<void()> wake_;
  std::atomic<std::int64_t> write_until_us_{INT64_MAX};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::multimap<Time, Again> again_;  ///< by due time
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace mirage
