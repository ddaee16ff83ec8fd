#pragma once
#include <vector>

#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

/// G1 to G4: meshes without extent, with impossible vertices.
std::vector<Case> geometry_vertex_cases();

}  // namespace mirage::extreme
