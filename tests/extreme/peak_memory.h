#pragma once
// Peak memory: the most memory that a process has used.

#include <cstddef>

namespace mirage::extreme {

/// Returns the process's own largest use of memory so far, bytes of addresses. A sanitizer reserves
/// those, so there it is what was allocated and not freed, from the first call on. Memory that a
/// sanitizer keeps for itself, such as redzones and freed blocks, is in neither.
std::size_t peak_bytes();
/// Returns the addresses of another process, or under a sanitizer its resident pages; 0: it is
/// gone.
std::size_t peak_bytes_of(int pid);

}  // namespace mirage::extreme
