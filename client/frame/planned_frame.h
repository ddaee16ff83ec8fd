#pragma once
// Planned frame: all that drawing a frame reads. The session plans it; screen and renderer take it
// as it is.

#include "client/frame/draw_list.h"
#include "client/frame/frame_setting.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"

namespace mirage {

class SceneView;

struct PlannedFrame {
  Camera camera;                     ///< the true one, with the size of the shown picture
  const SceneView* scene = nullptr;  ///< never null in a planned frame; its owner's
  DrawList list;
  Lighting lighting;
  FrameSetting setting = {};
  double tau_px = 1;
};

}  // namespace mirage
