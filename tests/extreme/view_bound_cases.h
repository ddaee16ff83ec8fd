#pragma once
#include <vector>

#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

/// V8 to V12: fields of view, viewports, far eyes, the bound.
std::vector<Case> view_bound_cases();

}  // namespace mirage::extreme
