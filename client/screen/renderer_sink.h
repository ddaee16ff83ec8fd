#pragma once
// Where a session's pixels and meshes go: the frame renderer.

#include <functional>

#include "client/session/tile_sink.h"
#include "protocol/base/error.h"

namespace mirage {

class FrameRenderer;

struct SinkHooks {
  std::function<const SceneView&()> scene;   ///< the session's
  std::function<void()> changed;             ///< texels, geometry or a scene came
  std::function<void(const Error&)> failed;  ///< it is not drawn, or not as it should be
};

/// `renderer` outlives the sink; a GL context is current when it is used.
TileSink renderer_sink(FrameRenderer& renderer, SinkHooks hooks);

}  // namespace mirage
