#pragma once
// What a load run measured, as JSON (DESIGN section 6) and as a short table.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mirage {

/// Differences of the server's own counters over the run; nullopt when it did not tell.
struct ServerDelta {
  std::uint64_t tiles_rendered = 0, tiles_merged = 0, store_hits = 0;
  std::uint64_t tiles_cancelled = 0, tiles_late = 0;
};

struct LoadResults {
  std::uint32_t clients = 0;
  std::uint32_t connected = 0;  ///< of them, when asking began
  std::uint32_t connected_at_end = 0;
  double duration_s = 0;  ///< asking
  double elapsed_s = 0;   ///< asking, and until the last answer where that came later
  std::uint64_t asked = 0;
  std::uint64_t distinct_asks = 0;
  std::uint64_t tiles = 0;
  std::uint64_t bytes = 0;
  std::vector<float> latency_ms;   ///< answer - intended time, one per tile
  std::vector<float> server_ms;    ///< of it, at the server, as it says
  std::vector<float> send_lag_ms;  ///< handed to the socket - intended time: our own share of it
  std::vector<float> away_ms;      ///< from a lost connection to the scene told anew, each
  std::uint64_t warmed = 0;        ///< of a shard, all that was to be done
  std::map<std::string, std::uint64_t> errors;
  std::uint64_t verified = 0;
  std::uint64_t verify_failures = 0;
  std::string first_failure;
  std::optional<ServerDelta> server;
};

std::string to_json(const LoadResults& results);
std::string to_table(const LoadResults& results);

}  // namespace mirage
