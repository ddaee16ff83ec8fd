#pragma once
// A list of things kept under a budget of bytes, ordered by their last use. The owner of a thing
// remembers its place in the list, and drops the things that take_excess() names.

#include <cstddef>
#include <list>
#include <optional>
#include <utility>

namespace mirage {

template <typename Key>
class ByteBudget {
  struct Entry {
    Key key;
    std::size_t bytes;
  };

 public:
  using Place = std::list<Entry>::iterator;

  explicit ByteBudget(std::size_t budget) : budget_(budget) {}

  /// Adds a thing of this size as the one used last.
  Place add(Key key, std::size_t bytes) {
    bytes_ += bytes;
    entries_.push_front({std::move(key), bytes});
    return entries_.begin();
  }
  void touch(Place place) { entries_.splice(entries_.begin(), entries_, place); }
  void grow(Place place, std::size_t bytes) {
    place->bytes += bytes;
    bytes_ += bytes;
  }
  /// Returns the key used longest ago while the sum is over budget, and stops counting it. One
  /// entry always stays.
  std::optional<Key> take_excess() {
    if (bytes_ <= budget_ || entries_.size() <= 1) return std::nullopt;
    Entry oldest = std::move(entries_.back());
    entries_.pop_back();
    bytes_ -= oldest.bytes;
    return std::move(oldest.key);
  }
  std::size_t bytes() const { return bytes_; }

 private:
  const std::size_t budget_;
  std::list<Entry> entries_;  ///< most recently used first
  std::size_t bytes_ = 0;
};

}  // namespace mirage
