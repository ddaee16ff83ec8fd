#pragma once
#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

/// L9: light that changes every frame, through the shipped server and client.
Outcome light_every_frame(const Conditions& conditions);

}  // namespace mirage::extreme
