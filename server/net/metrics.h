#pragma once
// What a server counts, in Prometheus' text format.

#include <cstdint>
#include <string>

#include "server/base/counters.h"
#include "server/session/hub_state.h"

namespace mirage {

/// Of a server, what does not change.
struct Identity {
  std::uint64_t revision = 0, profile = 0;
  std::string renderer;
};

std::string metrics_text(const Counters& counters, const HubState& state, const Identity& identity);

}  // namespace mirage
