#pragma once
// Names of the methods of drawing, on command lines and in reports.

#include <optional>
#include <string>
#include <vector>

#include "client/plan/tile_fit.h"

namespace mirage {

/// Returns all names, the cheapest method first. `fixed8` is a baseline
/// (MethodChoice::eight_views).
const std::vector<std::string>& method_names();
/// Returns the method with this name; nullopt: there is none.
std::optional<MethodChoice> method_from_name(const std::string& name);

}  // namespace mirage
