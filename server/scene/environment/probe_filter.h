#pragma once
// Prefilters surroundings into a light probe.

#include "protocol/impostor/light_probe.h"
#include "server/base/workers.h"
#include "server/scene/environment/equirect.h"

namespace mirage {

/// The same however many threads work. `image` has at least one texel.
LightProbe make_probe(const Equirect& image, const Workers& workers);

}  // namespace mirage
