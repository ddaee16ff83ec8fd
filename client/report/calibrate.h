#pragma once
// Calibrate: compares the error model with what was drawn, that is the predicted FLIP of each
// object's pixels with the measured one. It fits coefficients to some scenes, and tests them on
// others.

#include "client/report/context.h"

namespace mirage {

/// Writes calibration.csv (a row for each thing and compared frame), and prints the coefficients
/// that error_model.cpp should have.
Result<void> report_calibrate(Context& context);

}  // namespace mirage
