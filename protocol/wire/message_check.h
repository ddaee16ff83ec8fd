#pragma once
// Limits and value checks on a verified, not yet copied control part.

#include "protocol/base/result.h"
#include "wire_generated.h"

namespace mirage {

/// Checks counts against limits.h, that floats are finite and that required parts are present. A
/// FlatBuffer may point to one vector many times, so counts are checked before unpacking copies
/// them. Errors: kWireMalformed, kWireLimit, kWireValue.
Result<void> check_body(const wire::Control& control);

}  // namespace mirage
