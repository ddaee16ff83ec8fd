#pragma once

namespace mirage::test {

/// Allocations of this thread that still succeed; below 0: all do. A program that has
/// failing_memory.cpp takes its memory there, and so do the shared libraries that it loads.
extern thread_local long allocations_left;

}  // namespace mirage::test
