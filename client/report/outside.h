#pragma once
// Outside: results of other programs of Mirage: the extreme cases, and what scenes do not need.
// Each program is run; its rows are kept as a file of the report, and shown on the page.

#include <future>

#include "client/report/context.h"
#include "protocol/process/child.h"

namespace mirage {

/// A running mirage-extreme; not valid if there is none beside this program.
using ExtremeRun = std::future<Result<ChildResult>>;

/// Starts mirage-extreme while other parts run. Its cases measure no time, or they run alone among
/// themselves and compare with themselves.
ExtremeRun start_extreme(const Context& context);
/// Waits for it, and writes extreme.json. Cases that do not pass are failed checks.
Result<void> report_extreme(Context& context, ExtremeRun run);
/// Runs mirage-server SCENE --explain --prove --json, and writes needs.json. Components that differ
/// between FULL and LEAN are failed checks.
Result<void> report_needs(Context& context);

}  // namespace mirage
