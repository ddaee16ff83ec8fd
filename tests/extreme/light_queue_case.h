#pragma once
#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

/// L9: through the shipped server and client.
Outcome light_every_frame(const Conditions& conditions);

}  // namespace mirage::extreme
