#pragma once
#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

/// N5
Case killed_server_case();

}  // namespace mirage::extreme
