#pragma once
// Seams: places where a surface is one, but has a vertex for either side of them.

#include <vector>

#include "protocol/model/model.h"

namespace mirage {

/// By vertex its position; of those that are one but for rounding that of the first, bit for bit:
/// sin and cos of a whole turn leave a ball's first meridian beside its last by 1e-16, and such a
/// gap widens to the whole allowed error where either side is simplified on its own. One are those
/// within 2^-22 of the largest coordinate of all, in each axis by itself: a float's rounding of
/// that coordinate four times over, and a hundredth of what the wire's 16 bits of position leave.
/// Positions are finite.
std::vector<glm::vec3> closed_positions(const std::vector<Vertex>& vertices);

}  // namespace mirage
