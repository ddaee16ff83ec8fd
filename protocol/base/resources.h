#pragma once
// Resources: threads and memory that the machine, or a limit, gives this process.

#include <cstdint>
#include <exception>
#include <functional>

#include "protocol/base/result.h"

namespace mirage {

/// Threads that every program may need at the same time, besides one for each core: those of the
/// network, of messages, of images, and the renderer's own.
inline constexpr unsigned kFewestThreads = 6;

/// Starts this many threads at once, and ends them. Programs call it first, because some libraries
/// hang if they get too few. Error kResources: not so many can be started; it names the limits.
Result<void> require_threads(unsigned count);
/// Requires kFewestThreads, and one for each core.
Result<void> require_threads();

/// Least MB of addresses (ulimit -v) with which a renderer starts.
inline constexpr unsigned kRendererMb = 512;
/// Error kResources: the limit of addresses is lower than this.
Result<void> require_addresses(unsigned megabytes);

/// Returns the memory that this process may take: that of the machine, of its container (cgroup v2)
/// and of `ulimit -v`, whichever is least; bytes, at least 1 MB.
std::uint64_t memory_bytes();

/// Runs a program's main part and returns its exit code. An exception becomes the program's last
/// line, as error_of() says.
int run_program(const std::function<int()>& main_part);

/// Returns the error that an exception means, for the last line of a program: kResources if memory
/// or threads ran out, else kInternal.
Error error_of(const std::exception& exception);

}  // namespace mirage
