#pragma once

namespace mirage {

struct ServerOptions;

/// Looks whether this machine can serve with these options, prints a line a check (ok, warn, FAIL),
/// and gives the exit code: of the first that fails.
int run_doctor(const ServerOptions& options);

}  // namespace mirage
