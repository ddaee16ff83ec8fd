#pragma once
// Results of a load run, as JSON (docs/reference/load-statistics.md) and as a short table.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mirage {

/// Growth of the server's own counters over the run; nullopt if the server did not tell them.
struct ServerDelta {
  std::uint64_t tiles_rendered = 0, tiles_merged = 0, store_hits = 0;
  std::uint64_t tiles_cancelled = 0, tiles_late = 0;
};

struct LoadResults {
  std::uint32_t clients = 0;
  std::uint32_t connected = 0;  ///< clients connected when asking began
  std::uint32_t connected_at_end = 0;
  double duration_s = 0;  ///< time during which clients asked
  double elapsed_s = 0;   ///< until the last answer, at least `duration_s`
  std::uint64_t asked = 0;
  std::uint64_t distinct_asks = 0;
  std::uint64_t tiles = 0;
  std::uint64_t bytes = 0;
  std::vector<float> latency_ms;  ///< answer - intended time, one per tile
  /// the same of tiles that came after the run had given them up, which are not in `tiles`
  std::vector<float> late_ms;
  std::vector<float> server_ms;  ///< server's share of the latency, as the server says
  /// handed to the socket - intended time: the load client's own delay
  std::vector<float> send_lag_ms;
  /// per reconnect: from the lost connection until the scene is known again
  std::vector<float> away_ms;
  /// answered tiles of a --warm-shard run; such a run does nothing else
  std::uint64_t warmed = 0;
  std::map<std::string, std::uint64_t> errors;
  std::uint64_t verified = 0;
  std::uint64_t verify_failures = 0;
  std::string first_failure;
  std::optional<ServerDelta> server;
};

std::string to_json(const LoadResults& results);
std::string to_table(const LoadResults& results);

/// Returns a Markdown page with every figure of the JSON, its unit and its meaning.
std::string load_statistics_page();

}  // namespace mirage
