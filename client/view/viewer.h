#pragma once
// The viewing session: opens the link, drives the client stages frame by frame, compares, reports.

#include "client/view/options.h"
#include "protocol/base/result.h"

namespace mirage {

/// Runs to the end; 0, or the error to fail with.
Result<void> run_viewer(const ViewOptions& options);

}  // namespace mirage
