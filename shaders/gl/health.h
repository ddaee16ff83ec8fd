#pragma once
// Whether GL still does what it is told. GL thread only.

#include <string>

#include "protocol/base/result.h"

namespace mirage::gl {

/// What has gone wrong in the current context since the last call: it was lost (KHR_robustness), or
/// GL notes an error. `what` was being done. Error kGraphicsGl.
Result<void> check_health(const std::string& what);

/// What a program ends with: `code`, unless GL objects are left behind (gl_object.h). Then it says
/// so, and a program that had nothing else to tell ends with kInternal.
int exit_without_leaks(int code);

}  // namespace mirage::gl
