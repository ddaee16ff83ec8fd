#pragma once
// An ask and its reply, as window and pace learn from them.

#include <cstddef>
#include <cstdint>

namespace mirage {

struct TileTrip {
  std::int64_t sent_us = 0, came_us = 0;
  std::int64_t server_us = 0;  ///< for which the server had it
  std::size_t bytes = 0;       ///< as they came
  /// Bytes as counted when it was asked for: the window is compared with these.
  double expected = 0;
  std::size_t under_way = 0;  ///< asks without a reply when it was sent, itself among them
};

}  // namespace mirage
