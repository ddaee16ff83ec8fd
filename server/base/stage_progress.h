#pragma once
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <utility>

namespace mirage {

/// Reports the progress of a long loading stage every few seconds: "levels of detail: 12 of 77". A
/// stage that ends sooner is not mentioned. Any thread.
class StageProgress {
 public:
  using Tell = std::function<void(const std::string&)>;

  /// `tell` may be empty.
  StageProgress(const Tell& tell, std::string what, std::size_t count)
      : tell_(tell), what_(std::move(what)), count_(count) {}

  void one_done() {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++done_;
    const auto now = std::chrono::steady_clock::now();
    if (!tell_ || done_ == count_ || now - last_ < kPause) return;
    last_ = now;
    tell_(what_ + ": " + std::to_string(done_) + " of " + std::to_string(count_));
  }

 private:
  static constexpr std::chrono::seconds kPause{5};

  const Tell& tell_;
  const std::string what_;
  const std::size_t count_;
  std::mutex mutex_;
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace mirage
