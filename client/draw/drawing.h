#pragma once

#include "client/frame/draw_list.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"

namespace mirage {

class SceneView;

/// Input of all passes of a frame.
struct Drawing {
  Camera camera;                                  ///< at the size of the drawn picture
  DepthMapping mapping = DepthMapping::kForward;  ///< of the target's depth
  const SceneView& scene;
  const DrawList& list;
  const Lighting& lighting;
};

}  // namespace mirage
