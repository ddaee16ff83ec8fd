#include "server/stage/machine_share.h"

#include <sched.h>

#include <algorithm>
#include <thread>

namespace mirage {

int usable_cores() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof(allowed), &allowed) == 0) return CPU_COUNT(&allowed);
  // The set has no room for the cores of a very large machine.
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

int encoders_for(int cores, bool software_renderer) {
  constexpr int kOthers = 2, kMost = 14;
  return software_renderer ? 1 : std::clamp(cores - kOthers, 1, kMost);
}

}  // namespace mirage
