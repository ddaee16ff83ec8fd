#pragma once
#include <cstddef>
#include <string>

#include "server/base/counters.h"

namespace mirage {

/// The counters in the Prometheus text format.
std::string metrics_text(const Counters& counters, std::size_t clients);

}  // namespace mirage
