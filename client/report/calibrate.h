#pragma once
// The error model held against what was drawn: the FLIP of each object's pixels beside what was
// predicted of them; coefficients fitted to some scenes and judged on others.

#include "client/report/context.h"

namespace mirage {

/// Writes calibration.csv (a row for each thing and compared frame) and says the coefficients that
/// error_model.cpp should have.
Result<void> report_calibrate(Context& context);

}  // namespace mirage
