#pragma once
// C5: weather that gets worse and recovers.

#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

Case turning_weather_case();

}  // namespace mirage::extreme
