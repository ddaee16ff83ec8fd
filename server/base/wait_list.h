#pragma once
// Who waits for what is being made: it is made once, and all of them are served.

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
  /// True: nobody waited for it before.
  bool add(const Key& key, Waiter waiter) {
    const auto [at, is_new] = waiting_.try_emplace(key);
    at->second.push_back(std::move(waiter));
    ++count_;
    return is_new;
  }
  /// It is made for nobody yet. False: it is under way.
  bool begin(const Key& key) { return waiting_.try_emplace(key).second; }
  bool under_way(const Key& key) const { return waiting_.count(key) != 0; }
  /// It is made, or will not be: who waited for it.
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
  /// They wait no longer. Has `unwanted(key)` decide whether what nobody waits for any more is
  /// forgotten, too; else it goes on being made.
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
  /// Things that are being made.
  std::size_t under_way() const { return waiting_.size(); }
  /// Of all who wait.
  std::size_t size() const { return count_; }

 private:
  std::map<Key, std::vector<Waiter>> waiting_;
  std::size_t count_ = 0;
};

}  // namespace mirage
