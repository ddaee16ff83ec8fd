#include "server/stage/fetch_stage.h"

#include <spdlog/spdlog.h>

#include <new>

#include "server/tile/stage_queues.h"

namespace mirage {
namespace {

constexpr int kReaders = 2;
// time for writing after the server was told to stop
constexpr std::int64_t kLastWritesUs = 2'000'000;
constexpr std::size_t kMostAgain = 4096;
constexpr std::chrono::milliseconds kFirstPause{4}, kLongestPause{64};

}  // namespace

void FetchStage::start() {
  if (!queues_.store.has_sources()) return;
  for (int i = 0; i < kReaders; ++i) threads_.emplace_back([this] { read_all(); });
  threads_.emplace_back([this] { look_again(); });
  threads_.emplace_back([this] { write_all(); });
}

void FetchStage::announce(Completion done) {
  queues_.completions.push(std::move(done));
  wake_();
}

bool FetchStage::look(const FetchJob& job) {
  const SteadyClock clock;
  FetchedTile found;
  try {
    found = queues_.store.fetch(job.id, job.codec);
  } catch (const std::bad_alloc&) {
    spdlog::warn("a tile of the sources is done without: there is no memory for it");
  }
  queues_.counters.fetch_times.add(clock.now_us());
  const bool there = found.form || found.lossless;
  if (!there && !queues_.store.claim(job.id)) return false;
  announce(FinishedFetch{job.id, job.codec, std::move(found)});
  return true;
}

void FetchStage::read_all() {
  while (const std::optional<FetchJob> job = queues_.fetches.pop()) {
    if (look(*job)) continue;
    announce(look_later(*job, kFirstPause) ? Completion(PendingFetch{job->id, job->codec})
                                           : Completion(FinishedFetch{job->id, job->codec, {}}));
  }
}

bool FetchStage::look_later(const FetchJob& job, std::chrono::milliseconds pause) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (again_.size() >= kMostAgain) return false;
  again_.emplace(std::chrono::steady_clock::now() + pause,
                 Again{job, std::min(2 * pause, kLongestPause)});
  changed_.notify_one();
  return true;
}

void FetchStage::look_again() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ending_) {
    if (again_.empty()) {
      changed_.wait(lock);
    } else if (again_.begin()->first > std::chrono::steady_clock::now()) {
      changed_.wait_until(lock, Time(again_.begin()->first));
    } else {
      const Again next = again_.extract(again_.begin()).mapped();
      lock.unlock();
      if (!look(next.job) && !look_later(next.job, next.pause)) {
        announce(FinishedFetch{next.job.id, next.job.codec, {}});
      }
      lock.lock();
    }
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
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
}

}  // namespace mirage
