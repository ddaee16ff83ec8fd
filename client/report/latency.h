#pragma once
// Latency: compares Mirage, all geometry, video and video with timewarp on the same modelled link,
// over round trips and rates. Writes latency.csv and its section of the page.

#include "client/report/context.h"

namespace mirage {

/// Runs the part. It fails only if nothing can be measured at all; runs that fail become omissions.
Result<void> report_latency(Context& context);

}  // namespace mirage
