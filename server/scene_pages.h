#pragma once
// The description of the scene as clients get it after the welcome: images, objects, instances.

#include <memory>
#include <vector>

#include "protocol/wire.h"
#include "server/scene/prepared_scene.h"

namespace mirage {

using FramePtr = std::shared_ptr<const Bytes>;

/// Encoded pages, in the order they are sent; each within the limits of `protocol/limits.h`.
std::vector<FramePtr> make_scene_pages(const PreparedScene& scene);

}  // namespace mirage
