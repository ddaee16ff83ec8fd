#pragma once
// How a program ends with an error: one line on standard error, the exit code of error.h.

#include "protocol/base/error.h"

namespace mirage {

/// Prints the error; its exit code.
int fail(const Error& error);

}  // namespace mirage
