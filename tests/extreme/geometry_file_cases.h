#pragma once
#include <vector>

#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

/// G11 to G16: transforms, normals, nodes and counts of files; too many triangles, too thin ones.
std::vector<Case> geometry_file_cases();

}  // namespace mirage::extreme
