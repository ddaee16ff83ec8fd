#pragma once
// First: the first seconds of a session, counted from connecting. It compares Mirage,
// video with timewarp and the download of all geometry over three links. Writes first_seconds.csv,
// first_seconds_frames.csv and its section of the page.

#include "client/report/context.h"

namespace mirage {

/// Runs the part. Failed runs are listed as not measured. Errors as Context::open.
Result<void> report_first(Context& context);

}  // namespace mirage
