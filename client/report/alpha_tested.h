#pragma once
#include <cstdint>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// Returns a GLB file (glTF 2.0, section 4) in which every blended material is alpha-tested at one
/// half instead. The field's fidelity protocol calls this an alpha-tested model. Error
/// kSceneFormat.
Result<std::vector<std::uint8_t>> alpha_tested(const std::vector<std::uint8_t>& glb);

}  // namespace mirage
