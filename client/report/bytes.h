#pragma once
#include "client/report/context.h"

namespace mirage {

/// Measures what a walk costs in bytes: Mirage, all geometry, tiles only. Writes bytes.csv and its
/// section of the page.
Result<void> report_bytes(Context& context);

}  // namespace mirage
