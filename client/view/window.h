#pragma once
// A window with a GL context, and the camera a person steers in it.

#include <memory>
#include <string>

#include "protocol/camera.h"
#include "protocol/result.h"
#include "protocol/scene_types.h"

namespace mirage {

class Window {
 public:
  ~Window();
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;

  /// Error kGraphicsDevice when there is no display, with the way out as a hint.
  static Result<Window> create(int width, int height);

  /// Handles events; false when the window was closed.
  bool poll();
  void present();
  void framebuffer_size(int& width, int& height) const;
  bool overlay() const;

  /// Moves the camera by what was pressed since the last call.
  void steer(Pose& pose, double seconds, double speed_mps);

 private:
  Window();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mirage
