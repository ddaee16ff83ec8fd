#pragma once

namespace mirage {

struct ServerOptions;

/// Checks whether this machine can serve with these options. Prints a line per check (ok, warn,
/// FAIL), and returns the exit code of the first failed check.
int run_doctor(const ServerOptions& options);

}  // namespace mirage
