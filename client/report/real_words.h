#pragma once
// Words of the report's part about frames by the wall clock: what was found, and what falls short.

#include <string>
#include <vector>

#include "client/report/page.h"
#include "client/report/real_rows.h"

namespace mirage {

/// Returns the figures at the head of the section: the smallest budget that each scene holds; then,
/// within the largest budget, late frames, the longest frame and objects without an image. `runs`
/// has at least one.
std::vector<Finding> real_findings(const std::vector<RealRun>& runs);
/// Returns a line about what a run misses; empty: it misses nothing.
std::string real_shortfall(const RealRun& run);

}  // namespace mirage
