#pragma once
// Work precision: error against run time. It varies the error target tau for every method of
// drawing (numerics.md section 1). Writes work_precision.csv and its section of the page.

#include "client/report/context.h"

namespace mirage {

/// Runs the part. It fails only if nothing can be measured at all; runs that fail become omissions.
Result<void> report_work_precision(Context& context);

}  // namespace mirage
