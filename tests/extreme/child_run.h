#pragma once
// Child run: runs a case in a process of its own, so that a crash, a hang or a runaway allocation
// is a failed row, not the end of the report.

#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

struct ChildRun {
  Outcome outcome;
  double seconds = 0;
  long peak_mb = 0;  ///< largest resident set of the process and its ended children
};

/// Starts this program again for one case, and ends it at its time limit. Processes that a case
/// starts are in its process group, and end with it.
ChildRun run_in_child(const Case& one, const Conditions& conditions);

/// Runs the case in the child process, and hands the outcome to the parent.
void run_as_child(const Case& one, const Conditions& conditions);

}  // namespace mirage::extreme
