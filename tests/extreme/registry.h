#pragma once
// Registry: all cases, a list for each letter of numerics.md section 6. A letter's file defines its
// list; a new letter is a declaration here and a line in registry.cpp.

#include <optional>
#include <string>
#include <vector>

#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

std::vector<Case> geometry_cases();    ///< G
std::vector<Case> view_cases();        ///< V
std::vector<Case> lighting_cases();    ///< L
std::vector<Case> alpha_cases();       ///< A
std::vector<Case> depth_cases();       ///< D
std::vector<Case> texture_cases();     ///< T
std::vector<Case> network_cases();     ///< N
std::vector<Case> prediction_cases();  ///< P
std::vector<Case> control_cases();     ///< C
std::vector<Case> wire_cases();        ///< R

/// Returns every case in the order of numerics.md.
std::vector<Case> all_cases();

/// Returns an id that a letter with cases lacks or has twice; nullopt if all is in order.
std::optional<std::string> misplaced_id(const std::vector<Case>& cases);

}  // namespace mirage::extreme
