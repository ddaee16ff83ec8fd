#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace mirage {

/// How often something took how long; added to and read by any thread.
class TimeHistogram {
 public:
  /// Upper bounds in µs; above the last there is one more.
  static constexpr std::array<std::int64_t, 16> kBoundsUs = {
      100,    250,     500,     1'000,   2'500,     5'000,     10'000,    25'000,
      50'000, 100'000, 250'000, 500'000, 1'000'000, 2'500'000, 5'000'000, 10'000'000};

  void add(std::int64_t us) {
    std::size_t at = 0;
    while (at < kBoundsUs.size() && us > kBoundsUs[at]) ++at;
    ++counts_[at];
    sum_us_ += static_cast<std::uint64_t>(us > 0 ? us : 0);
  }
  std::uint64_t count(std::size_t bucket) const { return counts_[bucket]; }
  std::uint64_t sum_us() const { return sum_us_; }

 private:
  std::array<std::atomic<std::uint64_t>, kBoundsUs.size() + 1> counts_{};
  std::atomic<std::uint64_t> sum_us_{0};
};

/// What the server did so far; read by any thread, shown in stats and metrics.
struct Counters {
  std::atomic<std::uint64_t> tiles_asked{0};
  std::atomic<std::uint64_t> tiles_rendered{0};
  std::atomic<std::uint64_t> tiles_merged{0};
  std::atomic<std::uint64_t> tiles_cancelled{0};
  std::atomic<std::uint64_t> tiles_late{0};
  std::atomic<std::uint64_t> tiles_refused{0};
  std::atomic<std::uint64_t> forms_made{0};  ///< of tiles that were there in another codec
  std::atomic<std::uint64_t> store_hits{0};
  std::atomic<std::uint64_t> directory_hits{0};        ///< of them, of the cache's directory
  std::atomic<std::uint64_t> shared_store_hits{0};     ///< of them, of the store that servers share
  std::atomic<std::uint64_t> records_wrong{0};         ///< of tiles, that a source held
  std::atomic<std::uint64_t> tiles_left_to_others{0};  ///< another server was at them
  std::atomic<std::uint64_t> store_bytes{0};
  std::atomic<std::uint64_t> store_tiles{0};
  std::atomic<std::uint64_t> store_evictions{0};  ///< tiles let go for the budget
  std::atomic<std::uint64_t> tiles_not_saved{0};  ///< a source is too slow, full or gone
  /// Asks that did not wait for the directory any longer.
  std::atomic<std::uint64_t> fetches_given_up{0};
  std::atomic<std::uint64_t> pages_rendered{0};
  std::atomic<std::uint64_t> references_rendered{0};
  std::atomic<std::uint64_t> views_rendered{0};
  std::atomic<std::uint64_t> views_sent{0};
  std::atomic<std::uint64_t> gpu_scene_bytes{0};   ///< meshes, images, the shadow map
  std::atomic<std::uint64_t> gpu_target_bytes{0};  ///< pages, their targets, those on their way
  std::atomic<std::uint64_t> gpu_most_bytes{0};    ///< of all, with full renders
  std::atomic<std::uint64_t> shader_programs{0};   ///< compiled before the first ask
  std::atomic<std::uint64_t> shader_programs_after_ready{0};  ///< compiled while somebody waited
  std::atomic<std::uint64_t> meshes_sent{0};
  std::atomic<std::uint64_t> images_sent{0};
  std::atomic<std::uint64_t> bytes_sent{0};
  std::atomic<std::uint64_t> bytes_received{0};
  std::atomic<std::uint64_t> clients_closed_for_error{0};
  std::atomic<std::uint64_t> authentication_failures{0};
  std::atomic<std::uint64_t> upgrades_refused{0};   ///< handshakes that were none, or not allowed
  std::atomic<std::uint64_t> addresses_refused{0};  ///< with too many wrong hellos
  /// Of tiles_refused, by wire::RefusalReason.
  static constexpr std::array<const char*, 9> kReasons = {
      "other",        "busy", "bad-key",   "unknown-object", "no-geometry",
      "no-reference", "late", "too-large", "no-view"};
  std::array<std::atomic<std::uint64_t>, kReasons.size()> refused_for{};
  /// What tiles took: looked for in the sources, waiting, rendered, encoded; from ask to answer.
  TimeHistogram fetch_times, queue_times, render_times, encode_times, whole_times;
};

}  // namespace mirage
