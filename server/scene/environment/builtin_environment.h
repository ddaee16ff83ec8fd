#pragma once
// Surroundings that need no file.

#include <optional>
#include <string>

#include "server/scene/environment/equirect.h"

namespace mirage {

/// Returns built-in surroundings; nullopt for an unknown name. `studio`: gray walls with soft
/// boxes, exposed so that white diffuse surfaces are about 0.8 and nowhere above 1. `sky`: a clear
/// sky with a sun, and ground.
std::optional<Equirect> builtin_environment(const std::string& name);

}  // namespace mirage
