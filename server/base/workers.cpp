#include "server/base/workers.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace mirage {

struct Workers::Pool {
  /// One call of each(); lives on its caller's stack.
  struct Job {
    const std::function<void(std::size_t)>& work;
    const std::size_t count;
    std::atomic<std::size_t> next{0};
    std::size_t helpers = 0;  ///< threads at work on it, besides the caller
  };

  explicit Pool(std::size_t helpers) {
    for (std::size_t i = 0; i < helpers; ++i) threads.emplace_back([this] { help(); });
  }
  ~Pool() {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      stopping = true;
    }
    changed.notify_all();
    for (std::thread& thread : threads) thread.join();
  }

  void run(Job& job) {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      open.push_back(&job);
    }
    changed.notify_all();
    work_off(job);
    std::unique_lock<std::mutex> lock(mutex);
    forget(job);
    while (job.helpers > 0) {
      if (open.empty()) {
        changed.wait(lock);
      } else {
        take_part(lock);
      }
    }
  }

 private:
  void help() {
    std::unique_lock<std::mutex> lock(mutex);
    for (;;) {
      changed.wait(lock, [this] { return stopping || !open.empty(); });
      if (open.empty()) return;
      take_part(lock);
    }
  }

  // Works on the youngest job: it is the innermost one, and its caller is waiting.
  void take_part(std::unique_lock<std::mutex>& lock) {
    Job& job = *open.back();
    ++job.helpers;
    lock.unlock();
    work_off(job);
    lock.lock();
    forget(job);
    if (--job.helpers == 0) changed.notify_all();
  }

  static void work_off(Job& job) {
    for (std::size_t i = job.next++; i < job.count; i = job.next++) job.work(i);
  }
  void forget(const Job& job) {
    open.erase(std::remove(open.begin(), open.end(), &job), open.end());
  }

  std::mutex mutex;
  std::condition_variable changed;
  std::vector<Job*> open;  ///< jobs that may have indices left; youngest last
  bool stopping = false;
  std::vector<std::thread> threads;
};

Workers::Workers() = default;

Workers::Workers(std::size_t threads)
    : pool_(std::make_unique<Pool>(
          (threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency())) - 1)) {}

Workers::~Workers() = default;

void Workers::each(std::size_t count, const std::function<void(std::size_t)>& work) const {
  if (!pool_ || count < 2) {
    for (std::size_t i = 0; i < count; ++i) work(i);
    return;
  }
  Pool::Job job{work, count};
  pool_->run(job);
}

void Workers::both(const std::function<void()>& one, const std::function<void()>& other) const {
  each(2, [&](std::size_t i) { i == 0 ? one() : other(); });
}

}  // namespace mirage
