#pragma once
// Renderer sink: hands a session's pixels and meshes to the frame renderer.

#include <functional>

#include "client/session/tile_sink.h"
#include "protocol/base/error.h"

namespace mirage {

class FrameRenderer;

struct SinkHooks {
  std::function<const SceneView&()> scene;   ///< returns the session's scene
  std::function<void()> changed;             ///< texels, geometry or a scene arrived
  std::function<void(const Error&)> failed;  ///< something is not drawn, or not as it should be
};

/// Returns a sink that adds the time which this one takes to `ms`, by a clock in ms.
TileSink timed(TileSink sink, std::function<double()> now_ms, double& ms);

/// Returns the sink. `renderer` must outlive it, and a GL context must be current when it is used.
TileSink renderer_sink(FrameRenderer& renderer, SinkHooks hooks);

}  // namespace mirage
