#pragma once
#include <string>

#include "server/scene/prepared_scene.h"

namespace mirage {

/// The need analysis for people, or as JSON for tools. `shadows`: they were asked for.
std::string explain_needs(const PreparedScene& scene, bool shadows, bool json);

}  // namespace mirage
