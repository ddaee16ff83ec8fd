#pragma once
// What other programs of Mirage find out: the extreme cases, and what scenes do not need. Each is
// run, its rows are kept as a file of the report and shown on the page.

#include "client/report/context.h"

namespace mirage {

/// Runs mirage-extreme; extreme.json. Cases that do not pass are failed checks.
Result<void> report_extreme(Context& context);
/// Runs mirage-server SCENE --explain --prove --json; needs.json. Components that differ between
/// FULL and LEAN are failed checks.
Result<void> report_needs(Context& context);

}  // namespace mirage
