#pragma once
// Beside: what hostile peers cost a server, and a well-behaved client beside them.

#include <functional>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace mirage::test {

struct TileTimes {
  std::vector<double> ms;  ///< rising
  int missing = 0;         ///< tiles that did not arrive
  double at(double share) const;
};

struct Cost {
  TileTimes alone, beside;
  double before_mb = 0, most_mb = 0, after_mb = 0;  ///< resident memory of the server
  double more_mb() const { return most_mb - before_mb; }
};

/// A client asks for small tiles one after another, first alone, then while `hostile` runs. The
/// good client has the token. Prints the figures of `row`.
Cost cost_of(const std::string& row, const Server& server, const std::function<void()>& hostile,
             const std::string& token = "");

/// Expects that the client was always served, each tile within `most_ms`.
void expect_served(const Cost& cost, double most_ms);

double resident_mb(int pid);

/// Does `what` for 0 … count - 1, several at a time.
void at_once(std::size_t count, const std::function<void(std::size_t)>& what);

}  // namespace mirage::test
