#pragma once
// Reconnects: clients that have lost their server, when each tries again, and how long it was away.
// Input:  losses and returns of clients.
// Output: the clients that try now.
// Thread: the caller's; the time comes with every call.
// Full:   never; one entry a client.

#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

namespace mirage {

class Reconnects {
 public:
  explicit Reconnects(std::uint64_t seed) : seed_(seed) {}

  /// Notes a loss. The client tries again after 10 to 20 ms. Each further loss before it is back
  /// doubles that, up to a second.
  void lost(std::uint32_t client, std::int64_t now_us);
  /// Returns the clients that try now.
  std::vector<std::uint32_t> take_due(std::int64_t now_us);
  /// Notes that the client is back. Returns how long it was away, ms; nullopt: it was not away.
  std::optional<double> back(std::uint32_t client, std::int64_t now_us);
  /// Returns the number of clients that are not back.
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
