#pragma once
#include <cstdint>

#include "server/scene/scene.h"

namespace mirage {

/// Hash of all content of a scene that the pixels of tiles depend on: lighting and environment are
/// not part of it, as light is in the key and the sky in no tile.
std::uint64_t scene_revision(const Scene& scene);

}  // namespace mirage
