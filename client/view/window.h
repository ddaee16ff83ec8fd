#pragma once
// Window: a window with a GL context, and the camera that a person steers in it.

#include <memory>
#include <optional>
#include <string>

#include "client/screen/pilot.h"
#include "protocol/base/result.h"

namespace mirage {

/// Commands of the keys M, N and B.
enum class WindowCommand : std::uint8_t { kSteerMode, kFly, kNextClip, kNextVariant };

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

  /// Returns what keys and mouse have done since the last call, `seconds` ago.
  Steering take_steering(double seconds);
  /// Returns the place of the picture (0 to 1, right and down) that the mouse has begun to drag or
  /// scroll at since the last call.
  std::optional<glm::dvec2> take_aim();
  /// True if the command's key has been pressed since the last call.
  bool take(WindowCommand command);

 private:
  Window();
  bool after_events();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mirage
