#pragma once
// The only object, besides immutable bytes, that crosses threads.

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

namespace mirage {

/// Blocking queue for several producers and consumers. Producers choose what happens when it is
/// full: try_push() refuses, push() waits.
template <typename T>
class BoundedQueue {
 public:
  /// Weight of an item, and the largest sum of weights. An empty queue takes an item of any weight.
  struct Weight {
    std::function<std::size_t(const T&)> of;
    std::size_t most = SIZE_MAX;
  };

  explicit BoundedQueue(std::size_t capacity, Weight weight = {})
      : capacity_(capacity), weight_(std::move(weight)) {}

  /// Adds an item; false if the queue is full or closed, and `item` is then untouched.
  bool try_push(T& item) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_ || !has_room(item)) return false;
    weighs_ += weight_of(item);
    items_.push_back(std::move(item));
    not_empty_.notify_one();
    return true;
  }

  /// Adds an item, waiting while the queue is full; false if it is closed.
  bool push(T item) {
    std::unique_lock<std::mutex> lock(mutex_);
    not_full_.wait(lock, [&] { return closed_ || has_room(item); });
    if (closed_) return false;
    weighs_ += weight_of(item);
    items_.push_back(std::move(item));
    not_empty_.notify_one();
    return true;
  }

  /// Takes the oldest item, waiting while the queue is empty; nullopt once it is closed and
  /// drained.
  std::optional<T> pop() {
    std::unique_lock<std::mutex> lock(mutex_);
    not_empty_.wait(lock, [this] { return closed_ || !items_.empty(); });
    return take_front();
  }

  std::optional<T> try_pop() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return take_front();
  }

  /// Refuses further pushes; pops drain the rest.
  void close() {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    not_empty_.notify_all();
    not_full_.notify_all();
  }

  /// Returns the weight of all items in the queue.
  std::size_t weighs() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return weighs_;
  }
  std::size_t size() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return items_.size();
  }

 private:
  std::size_t weight_of(const T& item) const { return weight_.of ? weight_.of(item) : 0; }
  bool has_room(const T& item) const {
    if (items_.size() >= capacity_) return false;
    return items_.empty() || weighs_ + weight_of(item) <= weight_.most;
  }
  std::optional<T> take_front() {
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    weighs_ -= weight_of(*item);
    not_full_.notify_all();  // an item that does not fit may let a lighter one pass
    return item;
  }

  const std::size_t capacity_;
  const Weight weight_;
  mutable std::mutex mutex_;
  std::condition_variable not_empty_;
  std::condition_variable not_full_;
  std::deque<T> items_;
  std::size_t weighs_ = 0;
  bool closed_ = false;
};

}  // namespace mirage
