#pragma once
// Tile trip: the timing of an ask and its reply, from which ask_window.h and server_pace.h learn.

#include <cstddef>
#include <cstdint>

namespace mirage {

struct TileTrip {
  std::int64_t sent_us = 0, came_us = 0;
  std::int64_t server_us = 0;  ///< time between the ask's arrival at the server and its reply
  std::size_t bytes = 0;       ///< bytes of the reply
  /// Bytes expected when it was asked for; the window is compared with these.
  double expected = 0;
  std::size_t under_way = 0;  ///< unanswered asks when this one was sent, including itself
};

}  // namespace mirage
