#pragma once
// The description of the scene as clients get it: after the welcome its images, objects and what of
// its tree of groups the home view needs; the rest as it is asked for.

#include <memory>
#include <vector>

#include "protocol/message.h"
#include "server/scene/prepared_scene.h"

namespace mirage {

using FramePtr = std::shared_ptr<const Bytes>;

/// Encoded pages, in the order they are sent; each within the limits of `protocol/limits.h`. Of a
/// small scene it is everything.
std::vector<FramePtr> make_scene_pages(const PreparedScene& scene);

/// The pages that answer `request`; at least one. Groups that are not there, or more than a scene
/// has, are passed over.
std::vector<FramePtr> answer_open(const PreparedScene& scene, const wire::OpenRequestT& request);

}  // namespace mirage
