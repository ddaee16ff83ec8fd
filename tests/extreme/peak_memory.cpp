#include "tests/extreme/peak_memory.h"

#include <atomic>
#include <fstream>
#include <stdexcept>
#include <string>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// Declarations of <sanitizer/allocator_interface.h>, which GCC 12 has in its library but not as a
// header.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*taken)(const volatile void*,
                                                                       std::size_t),
                                                         void (*freed)(const volatile void*));
extern "C" std::size_t __sanitizer_get_allocated_size(const volatile void*);
#define MIRAGE_ALLOCATOR_HOOKS
#endif

namespace mirage::extreme {
namespace {

std::size_t read_status(const std::string& path, const std::string& key) {
  std::ifstream in(path);
  std::string line;
  while (std::getline(in, line)) {
    if (line.rfind(key, 0) == 0) return std::stoull(line.substr(key.size())) * 1024;
  }
  return 0;
}

#ifdef MIRAGE_ALLOCATOR_HOOKS
constexpr const char* kPeak = "VmHWM:";
// Signed, because blocks from before the first call are freed as well.
std::atomic<std::ptrdiff_t> held{0}, most_held{0};

void count_taken(const volatile void*, std::size_t bytes) {
  const auto n = static_cast<std::ptrdiff_t>(bytes);
  const std::ptrdiff_t now = held.fetch_add(n) + n;
  std::ptrdiff_t most = most_held.load();
  while (now > most && !most_held.compare_exchange_weak(most, now)) {
  }
}

void count_freed(const volatile void* block) {
  if (block) held -= static_cast<std::ptrdiff_t>(__sanitizer_get_allocated_size(block));
}
#else
constexpr const char* kPeak = "VmPeak:";
#endif

}  // namespace

std::size_t peak_bytes() {
#ifdef MIRAGE_ALLOCATOR_HOOKS
  static const int hooks = __sanitizer_install_malloc_and_free_hooks(count_taken, count_freed);
  if (hooks <= 0) throw std::runtime_error("the allocator cannot be watched");
  return static_cast<std::size_t>(most_held.load());
#else
  return read_status("/proc/self/status", kPeak);
#endif
}

std::size_t peak_bytes_of(int pid) {
  return read_status("/proc/" + std::to_string(pid) + "/status", kPeak);
}

}  // namespace mirage::extreme
