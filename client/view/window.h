#pragma once
// A window with a GL context, and the camera a person steers in it.

#include <memory>
#include <string>

#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"

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
  /// The same after sleeping until there is an event, a wake() or the time is over.
  bool wait(double seconds);
  /// From any thread: ends wait().
  static void wake();
  /// Whether the window system wants the picture drawn again, since the last call.
  bool take_refresh();
  void present();
  void framebuffer_size(int& width, int& height) const;
  /// Time between two pictures of the display.
  double refresh_ms() const;
  bool overlay() const;
  /// Of InsightLayer, by the keys 1 to 5: 0 is the picture alone.
  int layer() const;

  /// Moves the camera by what was pressed since the last call.
  void steer(Pose& pose, double seconds, double speed_mps);

 private:
  Window();
  bool after_events();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mirage
