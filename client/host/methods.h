#pragma once
// The names methods of drawing have on command lines and in reports.

#include <optional>
#include <string>
#include <vector>

#include "client/plan/tile_fit.h"

namespace mirage {

/// All names, the cheapest drawing first; `fixed8` is a baseline (MethodChoice::eight_views).
const std::vector<std::string>& method_names();
/// nullopt for a name that is none.
std::optional<MethodChoice> method_from_name(const std::string& name);

}  // namespace mirage
