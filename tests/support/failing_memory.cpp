// Memory that runs out on command. A file of its own, because a compiler that sees these operators
// and their calls together warns of mixing them with malloc().
#include "tests/support/failing_memory.h"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace mirage::test {
thread_local long allocations_left = -1;
}  // namespace mirage::test

void* operator new(std::size_t size) {
  long& left = mirage::test::allocations_left;
  if (left == 0) throw std::bad_alloc();
  if (left > 0) --left;
  void* const memory = std::malloc(std::max<std::size_t>(size, 1));
  if (!memory) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
