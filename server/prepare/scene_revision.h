#pragma once
#include <cstdint>

#include "server/scene/scene.h"

namespace mirage {

/// Returns a hash of all content of a scene that the pixels of tiles depend on. Lighting and
/// environment are not part of it, because light is in the key and the sky in no tile.
std::uint64_t scene_revision(const Scene& scene);

}  // namespace mirage
