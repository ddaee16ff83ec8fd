#include "server/stage/fetch_stage.h"

#include "server/tile/stage_queues.h"
#include "server/tile/tile_job.h"

namespace mirage {
namespace {

constexpr int kReaders = 2;
constexpr std::int64_t kLastWritesUs = 2'000'000;  // after the server was told to stop

}  // namespace

void FetchStage::start() {
  if (!queues_.store.has_directory()) return;
  for (int i = 0; i < kReaders; ++i) threads_.emplace_back([this] { read_all(); });
  threads_.emplace_back([this] { write_all(); });
}

void FetchStage::read_all() {
  while (const std::optional<FetchJob> job = queues_.fetches.pop()) {
    queues_.completions.push(
        FinishedFetch{job->id, job->codec, queues_.store.fetch(job->id, job->codec)});
    wake_();
  }
}

void FetchStage::write_all() {
  while (const std::optional<SaveJob> job = queues_.saves.pop()) {
    if (queues_.clock.now_us() > write_until_us_) continue;
    queues_.store.save(job->id, job->codec, *job->tile);
  }
}

void FetchStage::join() {
  write_until_us_ = queues_.clock.now_us() + kLastWritesUs;
  while (queues_.fetches.try_pop()) {
  }
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
}

}  // namespace mirage
