#pragma once
// List of waiters for things that are being made. A thing is made once for all who wait for it.

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

namespace mirage {

template <typename Key, typename Waiter>
class WaitList {
 public:
  /// Adds a waiter; true if the thing was not under way before.
  bool add(const Key& key, Waiter waiter) {
    const auto [at, is_new] = waiting_.try_emplace(key);
    at->second.push_back(std::move(waiter));
    ++count_;
    return is_new;
  }
  /// Starts a thing that nobody waits for yet; false if it is under way already.
  bool begin(const Key& key) { return waiting_.try_emplace(key).second; }
  bool under_way(const Key& key) const { return waiting_.count(key) != 0; }
  /// Ends a thing, made or failed, and returns its waiters.
  std::vector<Waiter> take(const Key& key) {
    auto node = waiting_.extract(key);
    if (node.empty()) return {};
    count_ -= node.mapped().size();
    return std::move(node.mapped());
  }
  template <typename Which>
  bool any(const Key& key, Which which) const {
    const auto at = waiting_.find(key);
    return at != waiting_.end() && std::any_of(at->second.begin(), at->second.end(), which);
  }
  template <typename Which>
  bool any(Which which) const {
    return std::any_of(waiting_.begin(), waiting_.end(), [&](const auto& entry) {
      return std::any_of(entry.second.begin(), entry.second.end(), which);
    });
  }
  template <typename Which>
  std::size_t count(Which which) const {
    std::ptrdiff_t all = 0;
    for (const auto& [key, waiters] : waiting_) {
      all += std::count_if(waiters.begin(), waiters.end(), which);
    }
    return static_cast<std::size_t>(all);
  }
  /// Removes the waiters that `which` selects. `unwanted(key)` decides whether a thing without any
  /// waiter left is dropped; otherwise it is still made.
  template <typename Which, typename Unwanted>
  void remove(Which which, Unwanted unwanted) {
    for (auto at = waiting_.begin(); at != waiting_.end();) {
      std::vector<Waiter>& all = at->second;
      const auto left = std::remove_if(all.begin(), all.end(), which);
      const bool waited = left != all.end();
      count_ -= static_cast<std::size_t>(all.end() - left);
      all.erase(left, all.end());
      at = waited && all.empty() && unwanted(at->first) ? waiting_.erase(at) : std::next(at);
    }
  }
  /// Number of things being made.
  std::size_t under_way() const { return waiting_.size(); }
  /// Number of all waiters.
  std::size_t size() const { return count_; }

 private:
  std::map<Key, std::vector<Waiter>> waiting_;
  std::size_t count_ = 0;
};

}  // namespace mirage
