#pragma once
// Runs a case in a process of its own: a crash, a hang or a runaway allocation is a failed row, not
// the end of the report.

#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

struct ChildRun {
  Outcome outcome;
  double seconds = 0;
  long peak_mb = 0;  ///< largest resident set of the process and those it waited for
};

/// Starts this program again for the one case, and ends it at its time limit. The processes a case
/// starts are of its process group, and end with it.
ChildRun run_in_child(const Case& one, const Conditions& conditions);

/// The other side: runs the case and hands the outcome to the process that asked.
void run_as_child(const Case& one, const Conditions& conditions);

}  // namespace mirage::extreme
