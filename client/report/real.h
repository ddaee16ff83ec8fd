#pragma once
// Real: frames by the wall clock, within several budgets.

#include "client/report/context.h"

namespace mirage {

/// Walks through each scene once per budget with mirage-server and mirage-view, which run as they
/// do for a user. Writes real.csv, real_stages.csv, real.json and a section of the page. The files
/// of the viewer stay in the folder real. Errors kIo; those of both programs for a scene of the
/// command line.
Result<void> report_real(Context& context);

}  // namespace mirage
