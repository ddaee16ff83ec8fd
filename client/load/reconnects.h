#pragma once
// Clients that have lost their server: when each tries again, and how long it was away.
// Thread: the caller's; time is what it is told.

#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

namespace mirage {

class Reconnects {
 public:
  explicit Reconnects(std::uint64_t seed) : seed_(seed) {}

  /// It tries again after 10 to 20 ms, at each further loss before it is back after twice as long,
  /// a second at most.
  void lost(std::uint32_t client, std::int64_t now_us);
  /// Those who try now.
  std::vector<std::uint32_t> take_due(std::int64_t now_us);
  /// It is as it was before; how long it was away, ms. nullopt: it was not.
  std::optional<double> back(std::uint32_t client, std::int64_t now_us);
  /// Those who are not back.
  std::size_t away() const { return away_.size(); }

 private:
  struct Away {
    std::int64_t since_us = 0;
    int tries = 0;
  };
  const std::uint64_t seed_;
  std::unordered_map<std::uint32_t, Away> away_;
  std::multimap<std::int64_t, std::uint32_t> tries_;  ///< by time
};

}  // namespace mirage
