#pragma once
// Finds impostors that lie in one another, such as a strap around a helmet.

#include <cstdint>
#include <vector>

#include "client/frame/draw_list.h"
#include "client/scene/scene_view.h"

namespace mirage {

/// Returns the instances, ascending, whose sphere holds the centre of another drawn impostor, and
/// those whose centre lies in another's sphere. Such things are in front of each other in turn, so
/// no order of drawing puts each soft edge over what is behind it.
std::vector<std::uint32_t> entangled(const std::vector<DrawnImpostor>& impostors,
                                     const SceneView& scene);

}  // namespace mirage
