#pragma once
// A full render of the server's, to hold a frame against.

#include <cstdint>
#include <vector>

namespace mirage {

struct ReferenceFrame {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  std::vector<float> depth;        ///< eye depth, m; 0: none
  std::vector<std::uint32_t> ids;  ///< instance + 1; 0: none
};

}  // namespace mirage
