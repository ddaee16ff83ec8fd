#pragma once
// Load of the sessions, for monitoring a server.

#include <cstddef>

namespace mirage {

struct HubState {
  std::size_t clients = 0;
  std::size_t strangers = 0;     ///< connections without a valid hello
  std::size_t outbox_bytes = 0;  ///< bytes waiting to be sent, over all sessions
  std::size_t largest_outbox_bytes = 0;
  std::size_t tiles_queued = 0;  ///< waiting to be rendered
  std::size_t pixels_bytes = 0;  ///< rendered pixels waiting to be encoded
  bool draining = false;
};

}  // namespace mirage
