#pragma once
// Fetch stage: whatever has to do with the sources of finished tiles.
// Input:  tiles to look for; tiles to be kept. Output: what was found, announced to the network
//         loop.
// Thread: readers, one that looks again for what another server renders, and a writer: a source
//         that takes seconds holds up nobody else.
// Full:   an ask goes past the sources and is rendered; a finished tile is not kept.

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

  /// Without sources there is nothing to do, and no thread.
  void start();
  /// Ends the threads; both inputs must have been closed. What is not written within two seconds
  /// is not kept.
  void join();

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Again {
    FetchJob job;
    std::chrono::milliseconds pause;  ///< before the look after the next
  };

  void read_all();
  void look_again();
  void write_all();
  /// Announces what was found, or that nothing was and it is this server's to render. False:
  /// another server is at it.
  bool look(const FetchJob& job);
  /// False: too many are.
  bool look_later(const FetchJob& job, std::chrono::milliseconds pause);
  void announce(Completion done);

  StageQueues& queues_;
  std::function<void()> wake_;
  std::atomic<std::int64_t> write_until_us_{INT64_MAX};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::multimap<Time, Again> again_;  ///< by when
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace mirage
