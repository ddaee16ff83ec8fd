#pragma once
#include <string>

#include "server/scene/prepared_scene.h"

namespace mirage {

/// The need analysis for people, or as JSON for tools.
std::string explain_needs(const PreparedScene& scene, bool json);

}  // namespace mirage
