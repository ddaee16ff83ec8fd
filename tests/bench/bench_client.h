#pragma once
// Bench client: a client in this process, its GL context and a target to draw into.

#include <memory>
#include <optional>

#include "client/door/client.h"
#include "client/draw/frame_target.h"
#include "client/frame/draw_list.h"
#include "client/host/client_host.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "shaders/gl/egl_context.h"

namespace mirage::bench {

class BenchClient {
 public:
  struct View {
    int width = 0, height = 0;
    int samples = 0;  ///< of a pixel; 0: one
  };
  /// Connects and waits for the scene. `host.session` sets the size of the atlas.
  static Result<std::unique_ptr<BenchClient>> create(const HostOptions& host, const View& view);

  ClientHost& host() { return *host_; }
  ClientSession& session() { return host_->session(); }
  const SceneView& scene() const { return host_->session().scene(); }
  const FrameTarget& target() const { return *target_; }
  /// Draws what the session planned, with its lighting, and waits until it is drawn.
  void draw(const FrameTarget& target, const PlannedFrame& frame);

 private:
  BenchClient() = default;
  gl::EglContext egl_;
  Client client_;
  std::optional<FrameTarget> target_;
  std::unique_ptr<ClientHost> host_;
};

}  // namespace mirage::bench
