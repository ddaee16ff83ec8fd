#pragma once
// How much there is at the sessions, for who watches a server.

#include <cstddef>

namespace mirage {

struct HubState {
  std::size_t clients = 0;
  std::size_t strangers = 0;     ///< have not said a right hello
  std::size_t outbox_bytes = 0;  ///< wait to be sent, of all
  std::size_t largest_outbox_bytes = 0;
  std::size_t tiles_queued = 0;  ///< to be rendered
  std::size_t pixels_bytes = 0;  ///< rendered, to be encoded
  bool draining = false;
};

}  // namespace mirage
