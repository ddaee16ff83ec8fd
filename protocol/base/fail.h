#pragma once
// The end of a program with an error: one line on standard error, and an exit code of error.h.

#include "protocol/base/error.h"

namespace mirage {

/// Prints the error and returns its exit code.
int fail(const Error& error);

}  // namespace mirage
