#pragma once
// Error against run time: the error target tau swept for every method of drawing (numerics.md
// section 1). Writes work_precision.csv and its section of the page.

#include "client/report/context.h"

namespace mirage {

/// An error only where nothing can be measured at all; runs that fail become omissions.
Result<void> report_work_precision(Context& context);

}  // namespace mirage
