#include "protocol/base/fail.h"

#include <cstdio>

namespace mirage {

int fail(const Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  return static_cast<int>(exit_code(error.id));
}

}  // namespace mirage
