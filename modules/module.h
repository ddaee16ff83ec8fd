#pragma once
// Module: a shared library of Mirage that a program loads at first need, not at its start.

#include <string>

#include "protocol/base/result.h"

namespace mirage {

/// Loads lib`name`.so and returns the address of its function `entry`. The library is looked for
/// beside the program (a build), in ../lib/mirage (an installation), then in ../lib (a bundle). It
/// stays loaded. Error kModule: it is missing, does not load, or is of another build.
Result<void*> load_module(const std::string& name, const char* entry);

}  // namespace mirage
