#pragma once
// How much memory a process has taken at most.

#include <cstddef>

namespace mirage::extreme {

/// The process's own largest use of memory so far, in bytes: of addresses, or, where a sanitizer
/// reserves those, of what was asked of its allocator and not given back, from the first call on.
/// What a sanitizer keeps for itself, redzones and freed blocks, is in neither.
std::size_t peak_bytes();
/// Addresses of another process, under a sanitizer its resident pages; 0 when it is gone.
std::size_t peak_bytes_of(int pid);

}  // namespace mirage::extreme
