#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace mirage {

/// Histogram of how long something took. Any thread adds to it and reads it.
class TimeHistogram {
 public:
  /// Upper bounds in µs; one more bucket holds everything above the last.
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

/// Counts of the server's work so far, shown in stats and metrics. Any thread reads them.
struct Counters {
  std::atomic<std::uint64_t> tiles_asked{0};
  std::atomic<std::uint64_t> tiles_rendered{0};
  std::atomic<std::uint64_t> tiles_merged{0};
  std::atomic<std::uint64_t> tiles_cancelled{0};
  std::atomic<std::uint64_t> tiles_late{0};
  std::atomic<std::uint64_t> tiles_refused{0};
  std::atomic<std::uint64_t> forms_made{0};  ///< tiles converted from another codec
  std::atomic<std::uint64_t> store_hits{0};
  std::atomic<std::uint64_t> directory_hits{0};        ///< those from the cache's directory
  std::atomic<std::uint64_t> shared_store_hits{0};     ///< those from the store that servers share
  std::atomic<std::uint64_t> records_wrong{0};         ///< damaged tiles found in a source
  std::atomic<std::uint64_t> tiles_left_to_others{0};  ///< tiles that another server was rendering
  std::atomic<std::uint64_t> store_bytes{0};
  std::atomic<std::uint64_t> store_tiles{0};
  std::atomic<std::uint64_t> store_evictions{0};  ///< tiles dropped to keep the budget
  std::atomic<std::uint64_t> tiles_not_saved{0};  ///< because a source was too slow, full or gone
  /// Asks that stopped waiting for the tile sources.
  std::atomic<std::uint64_t> fetches_given_up{0};
  std::atomic<std::uint64_t> pages_rendered{0};
  std::atomic<std::uint64_t> references_rendered{0};
  std::atomic<std::uint64_t> views_rendered{0};
  std::atomic<std::uint64_t> views_sent{0};
  std::atomic<std::uint64_t> pictures_sent{0};
  std::atomic<std::uint64_t> gpu_scene_bytes{0};   ///< meshes, images, the shadow map
  std::atomic<std::uint64_t> gpu_target_bytes{0};  ///< render targets, pages, pages in read-back
  std::atomic<std::uint64_t> gpu_most_bytes{0};    ///< highest sum so far, full renders included
  std::atomic<std::uint64_t> shader_programs{0};   ///< compiled before the first ask
  std::atomic<std::uint64_t> shader_programs_after_ready{0};  ///< compiled while a client waited
  std::atomic<std::uint64_t> meshes_sent{0};
  std::atomic<std::uint64_t> images_sent{0};
  std::atomic<std::uint64_t> bytes_sent{0};
  std::atomic<std::uint64_t> bytes_received{0};
  std::atomic<std::uint64_t> clients_closed_for_error{0};
  std::atomic<std::uint64_t> authentication_failures{0};
  std::atomic<std::uint64_t> upgrades_refused{0};   ///< invalid or forbidden handshakes
  std::atomic<std::uint64_t> addresses_refused{0};  ///< addresses that sent too many wrong hellos
  /// Labels of refused_for, in the order of wire::RefusalReason.
  static constexpr std::array<const char*, 9> kReasons = {
      "other",        "busy", "bad-key",   "unknown-object", "no-geometry",
      "no-reference", "late", "too-large", "no-view"};
  std::array<std::atomic<std::uint64_t>, kReasons.size()> refused_for{};
  /// Times of tiles: in the fetch stage, in the queue, rendering, encoding, and from ask to answer.
  TimeHistogram fetch_times, queue_times, render_times, encode_times, whole_times;
};

}  // namespace mirage
