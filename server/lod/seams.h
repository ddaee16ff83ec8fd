#pragma once
// Seams: places where a surface is continuous, but has a vertex for either side.

#include <vector>

#include "protocol/model/model.h"

namespace mirage {

/// Returns the position of each vertex. Positions that differ only by rounding become equal, bit
/// for bit, to the first of them.
///
/// Example: sin and cos of a whole turn leave a ball's first meridian 1e-16 beside its last. Such a
/// gap would widen to the whole allowed error once either side is simplified on its own.
///
/// Positions count as equal within 2^-22 of the largest coordinate of all, on each axis. That is
/// four times a float's rounding of that coordinate, and a hundredth of the error of the wire's
/// 16-bit positions. Positions must be finite.
std::vector<glm::vec3> closed_positions(const std::vector<Vertex>& vertices);

}  // namespace mirage
