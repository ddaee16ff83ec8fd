#pragma once
// Sorts by one number. std::stable_sort would be compiled anew for each type: 4 KB of a page's
// program each.

#include <cstddef>
#include <utility>
#include <vector>

namespace mirage {

/// Returns the places 0 … n-1 in the order of their keys, the least first. Equal keys keep their
/// order; NaN comes last.
std::vector<std::size_t> ascending(const std::vector<double>& keys);

/// Sorts by `key(item)`, a double, the least first. Equals keep their order; NaN comes last.
template <typename T, typename Key>
void sort_ascending(std::vector<T>& items, const Key& key) {
  std::vector<double> keys;
  keys.reserve(items.size());
  for (const T& item : items) keys.push_back(key(item));
  std::vector<T> sorted;
  sorted.reserve(items.size());
  for (const std::size_t at : ascending(keys)) sorted.push_back(std::move(items[at]));
  items = std::move(sorted);
}

/// Sorts by `key(item)` with the greatest first; NaN comes last as well.
template <typename T, typename Key>
void sort_descending(std::vector<T>& items, const Key& key) {
  sort_ascending(items, [&](const T& item) { return -key(item); });
}

}  // namespace mirage
