#pragma once
// Viewer: runs a viewing session. It opens the link, drives the client stages frame by frame,
// compares and reports.

#include "client/view/options.h"
#include "protocol/base/result.h"

namespace mirage {

/// Runs to the end. Returns the error if it fails.
Result<void> run_viewer(const ViewOptions& options);

}  // namespace mirage
