#include "server/base/huge_pages.h"

#include <unistd.h>

#include <climits>
#include <cstdlib>
#include <fstream>
#include <string>

namespace mirage {
namespace {

constexpr const char* kVariable = "GLIBC_TUNABLES";

// True if the kernel gives huge pages to those who ask for them.
bool are_given_on_request() {
  std::ifstream file("/sys/kernel/mm/transparent_hugepage/enabled");
  std::string modes;
  return std::getline(file, modes) && modes.find("[madvise]") != std::string::npos;
}

}  // namespace

// The allocator reads the variable once, before main(); no call sets it later.
void use_huge_pages(char** argv) {
  if (std::getenv(kVariable) || !are_given_on_request()) return;
  // The path, and not /proc/self/exe itself: the process keeps its name.
  char path[PATH_MAX];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof(path) - 1);
  if (length <= 0) return;
  path[length] = '\0';
  if (setenv(kVariable, "glibc.malloc.hugetlb=1", 1) == 0) execv(path, argv);
}

}  // namespace mirage
