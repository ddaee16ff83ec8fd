#pragma once
#include <cstdint>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// A GLB file (glTF 2.0, section 4) with every blended material alpha-tested at one half instead:
/// what the field's fidelity protocol calls an alpha-tested model. Error kSceneFormat.
Result<std::vector<std::uint8_t>> alpha_tested(const std::vector<std::uint8_t>& glb);

}  // namespace mirage
