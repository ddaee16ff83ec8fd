#pragma once
// Checks whether GL still works. GL thread only.

#include <string>

#include "protocol/base/result.h"

namespace mirage::gl {

/// Reports problems of the current context since the last call: it was lost (KHR_robustness), or GL
/// has an error. `what` names the work in progress. Error kGraphicsGl.
Result<void> check_health(const std::string& what);

/// Returns the exit code of a program: `code`, unless GL objects are left (gl_object.h). Then it
/// prints an error, and a `code` of success becomes kInternal.
int exit_without_leaks(int code);

}  // namespace mirage::gl
