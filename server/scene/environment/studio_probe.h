#pragma once
// The light probe of the built-in studio. It is made when the server is built, because most scenes
// without lights stand in the studio: making it took a third of a small model's time of loading.

#include "protocol/impostor/light_probe.h"

namespace mirage {

/// Returns make_probe() of builtin_environment("studio").
LightProbe studio_probe();

}  // namespace mirage
