#pragma once
// Fetch stage: whatever has to do with the tile cache's directory.
// Input:  tiles to look for; tiles to be kept. Output: what was found, announced to the network
//         loop.
// Thread: readers and a writer of its own: a disk that takes seconds holds up nobody else.
// Full:   an ask goes past the directory and is rendered; a finished tile is not kept.

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

namespace mirage {

struct StageQueues;

class FetchStage {
 public:
  FetchStage(StageQueues& queues, std::function<void()> wake)
      : queues_(queues), wake_(std::move(wake)) {}
  ~FetchStage() { join(); }

  /// Without a directory there is nothing to do, and no thread.
  void start();
  /// Ends the threads; both inputs must have been closed. What is not written within two seconds
  /// is not kept.
  void join();

 private:
  void read_all();
  void write_all();

  StageQueues& queues_;
  std::function<void()> wake_;
  std::atomic<std::int64_t> write_until_us_{INT64_MAX};
  std::vector<std::thread> threads_;
};

}  // namespace mirage
