#pragma once
// Prefilters surroundings into a light probe.

#include "protocol/impostor/light_probe.h"
#include "server/base/workers.h"
#include "server/scene/environment/equirect.h"

namespace mirage {

/// Returns the probe of an image with at least one texel. The number of threads changes nothing.
LightProbe make_probe(const Equirect& image, const Workers& workers);

}  // namespace mirage
