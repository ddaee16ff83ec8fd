#pragma once

#include <cstdint>
#include <string>

namespace mirage {

class ClientHost;
class ClientSession;
struct DrawList;

/// Figures of the window's overlay that only its frame loop knows.
struct OverlayFigures {
  double frame_ms = 0;  ///< smoothed
  int draw_calls = 0;   ///< of the last picture
};

/// Returns the figures that lie over the picture, a line each. `list` is of the last frame, planned
/// at `now_us`.
std::string overlay_text(const ClientHost& host, const DrawList& list,
                         const OverlayFigures& figures, std::int64_t now_us);

}  // namespace mirage
