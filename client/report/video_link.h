#pragma once
// Video link: the video baseline's way to the screen. It tells when each frame arrives over the
// same modelled link, and does the rotational timewarp.

#include <cstdint>
#include <vector>

#include "client/link/net_model.h"
#include "protocol/impostor/camera.h"

namespace mirage {

struct VideoTiming {
  double fps = 60;
  double render_ms =
      0;  ///< at the server, per frame, pipelined: it delays frames, but does not limit their rate
  double encode_ms = 0, decode_ms = 0;
};

/// Returns the number of the first frame whose pose can be sent. Connecting takes two round trips,
/// as for every other method.
int first_video_frame(const NetModel& net, double fps);

/// Returns when frame first + i, of bytes[i], can be shown, µs from the start of the connection.
/// Its pose is sent up at its own time (frame number / fps). Frames follow one another on the link.
std::vector<std::int64_t> video_arrivals(const std::vector<std::size_t>& bytes, int first,
                                         const VideoTiming& timing, const NetModel& net);

/// Bytes on the wire for a frame's pose going up, and around a frame coming down.
inline constexpr std::size_t kPoseBytes = 80;
inline constexpr std::size_t kVideoFraming = 28;

/// Turns `shown` (RGBA8, seen by `then`) to the orientation of `now`, bilinear. Pixels without
/// content become black with alpha 255; `outside` is their number.
std::vector<std::uint8_t> timewarp(const std::vector<std::uint8_t>& shown, const Camera& then,
                                   const Camera& now, std::size_t& outside);

}  // namespace mirage
