#pragma once
// Bench: a benchmark measures the cost of something, and of something to compare it with. Both are
// measured in the same run, by turns: other load of the machine changes a ratio less than a time.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage::bench {

/// One line of the table.
struct Row {
  std::string what;
  std::string ours;    ///< with its unit
  std::string beside;  ///< floor or peer, named, with its unit
  double ratio = 0;    ///< ratio of the two, as `goal` means it
  std::string goal;    ///< in words; empty: there is none
  bool met = true;
  /// Half the range between the quartiles, per cent of the median; nullopt for a single
  /// measurement.
  std::optional<double> spread_pct = {};
  std::string note = {};
};

struct Conditions {
  bool quick = false;
  std::string device = "auto";  ///< EGL device, for benchmarks that use one
};

struct Bench {
  const char* id;
  const char* what;
  std::function<Result<std::vector<Row>>(const Conditions&)> run;
  bool hardware = false;  ///< left out on a software renderer unless it is asked for
};

std::vector<Bench> selection_benches();
std::vector<Bench> tile_benches();
std::vector<Bench> store_benches();
std::vector<Bench> startup_benches();
std::vector<Bench> latency_benches();
std::vector<Bench> codec_benches();
std::vector<Bench> client_benches();
std::vector<Bench> price_benches();
std::vector<Bench> gpu_benches();

/// True if the EGL device ("auto": the best there is) is a graphics card. Error kGraphicsDevice.
Result<bool> is_hardware(const std::string& device);

/// Times of two things, measured by turns.
struct Pair {
  double ours_s = 0, beside_s = 0;  ///< medians
  double ratio = 0;                 ///< median of beside over ours, round by round
  double spread_pct = 0;
};

enum class Time { kWall, kCpu };  ///< CPU: time of all threads, for software renderers have several
/// Returns the seconds that `work` takes.
double seconds(Time time, const std::function<void()>& work);
/// Measures both `rounds` times, by turns, after one round that does not count.
Pair in_turn(Time time, int rounds, const std::function<void()>& ours,
             const std::function<void()>& beside);
/// Median of samples, and half the distance of the quartiles in per cent of it.
struct Middle {
  double median = 0, spread_pct = 0;
};
Middle middle(std::vector<double> samples);

}  // namespace mirage::bench
