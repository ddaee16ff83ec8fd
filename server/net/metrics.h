#pragma once
// The server's counts in Prometheus' text format.

#include <cstdint>
#include <string>

#include "server/base/counters.h"
#include "server/session/hub_state.h"

namespace mirage {

/// Facts of a server that stay constant while it runs.
struct Identity {
  std::uint64_t revision = 0, profile = 0;
  std::string renderer;
};

/// Returns the reply to GET /metrics: every metric with its help.
std::string metrics_text(const Counters& counters, const HubState& state, const Identity& identity);

/// Returns every metric with type, meaning and labels, as a Markdown page.
std::string metrics_page();

}  // namespace mirage
