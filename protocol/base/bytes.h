#pragma once

#include <cstdint>
#include <vector>

namespace mirage {

using Bytes = std::vector<std::uint8_t>;

}  // namespace mirage
