#pragma once
// Surface: what a viewer draws to: a window with its overlays, or a context without one.
// Input:  the client's picture of a frame.
// Output: that picture on the display; nothing without a window.
// Thread: the GL thread.
// Full:   never.

#include <cstdint>
#include <optional>

#include "client/draw/insight.h"
#include "client/draw/presenter.h"
#include "client/view/overlay.h"
#include "client/view/window.h"
#include "protocol/base/result.h"
#include "shaders/gl/egl_context.h"

namespace mirage {

class Client;
class ClientHost;
class Clock;
struct ViewOptions;

class Surface {
 public:
  /// Makes a context current, of a window or offscreen. Errors kGraphicsDevice, kGraphicsShader.
  Result<void> open(const ViewOptions& options);

  /// Returns the window; nullptr: there is none.
  Window* window() { return window_ ? &*window_ : nullptr; }

  /// Gives the client's picture the size of the window, if there is one. Error kGraphicsGl.
  Result<void> fit(Client& client) const;
  /// Shows the client's picture in the window, with what lies over it. `frame_ms` is for the
  /// overlay. Returns when, by `clock`, the picture was ready to be presented.
  Result<std::int64_t> show(Client& client, const ClientHost& host, double frame_ms,
                            const Clock& clock);

 private:
  std::optional<Window> window_;
  gl::EglContext egl_;
  std::optional<Presenter> presenter_;  // for the window
  std::optional<Insight> insight_;      // for the window
  std::optional<Overlay> overlay_;      // for the window
};

}  // namespace mirage
