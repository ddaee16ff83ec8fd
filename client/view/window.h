#pragma once
// Window: a window with a GL context, and the camera that a person steers in it.

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

  /// Opens a window. Error kGraphicsDevice if there is no display; its hint tells what to do.
  static Result<Window> create(int width, int height);

  /// Handles events. Returns false if the window was closed.
  bool poll();
  /// Sleeps until there is an event, a wake() or the time is over, then does the work of poll().
  bool wait(double seconds);
  /// Ends wait(); may be called from any thread.
  static void wake();
  /// True if the window system has asked for the picture to be drawn again since the last call.
  bool take_refresh();
  void present();
  void framebuffer_size(int& width, int& height) const;
  /// Returns the time between two pictures of the display, ms.
  double refresh_ms() const;
  bool overlay() const;
  /// True if the space bar has stopped the animation.
  bool stopped() const;
  /// Returns the InsightLayer chosen by the keys 1 to 5; 0: the picture alone.
  int layer() const;

  /// Moves the camera by the keys pressed and the mouse since the last call.
  void steer(Pose& pose, double seconds, double speed_mps);

 private:
  Window();
  bool after_events();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mirage
