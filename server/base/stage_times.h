#pragma once
#include <chrono>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace mirage {

/// Durations of the stages of a start, one after the other.
class StageTimes {
 public:
  /// Ends a stage named `what`: its time runs from the last call, or from the constructor.
  void done(std::string what) {
    const auto now = std::chrono::steady_clock::now();
    seconds_.emplace_back(std::move(what), std::chrono::duration<double>(now - last_).count());
    last_ = now;
  }
  /// Returns a summary such as "1.52 s: file 0.31, levels of detail 1.21".
  std::string words() const {
    double sum = 0;
    std::string each;
    char text[32];
    for (const auto& [what, seconds] : seconds_) {
      sum += seconds;
      std::snprintf(text, sizeof(text), " %.2f", seconds);
      each += (each.empty() ? "" : ", ") + what + text;
    }
    std::snprintf(text, sizeof(text), "%.2f s: ", sum);
    return text + each;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::vector<std::pair<std::string, double>> seconds_;
};

}  // namespace mirage
