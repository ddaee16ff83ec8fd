#pragma once
// Reference frame: a full render by the server, to compare a displayed frame with.

#include <cstdint>
#include <vector>

namespace mirage {

struct ReferenceFrame {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  std::vector<float> depth;        ///< eye depth of each pixel, m; 0: nothing there
  std::vector<std::uint32_t> ids;  ///< instance + 1 of each pixel; 0: nothing there
};

}  // namespace mirage
