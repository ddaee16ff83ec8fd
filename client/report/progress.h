#pragma once
#include <string>

#include "protocol/base/clock.h"

namespace mirage {

/// Prints what is being done, how far it is, and how long the rest of the part may take.
class Progress {
 public:
  /// Begins a part of `steps` steps.
  void begin(const std::string& part, std::size_t steps);
  /// Begins a step: prints a line on standard error.
  void step(const std::string& what);
  double elapsed_s() const { return static_cast<double>(clock_.now_us()) * 1e-6; }

 private:
  SteadyClock clock_;
  std::string part_;
  std::size_t steps_ = 0, done_ = 0;
  double began_s_ = 0;
};

}  // namespace mirage
