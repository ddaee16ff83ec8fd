#pragma once
// The video baseline's way to the screen: when each of its frames is there, over the same modelled
// link; and the rotational timewarp.

#include <cstdint>
#include <vector>

#include "client/link/net_model.h"
#include "protocol/impostor/camera.h"

namespace mirage {

struct VideoTiming {
  double fps = 60;
  double render_ms = 0;  ///< at the server, per frame, pipelined: it delays and does not limit
  double encode_ms = 0, decode_ms = 0;
};

/// Number of the first frame whose pose can be sent: connecting takes two round trips, as for every
/// other method.
int first_video_frame(const NetModel& net, double fps);

/// When frame first + i, of bytes[i], is ready to be shown, µs from the start of the connection.
/// Its pose is sent up at its own time (frame number / fps); frames follow one another on the link.
std::vector<std::int64_t> video_arrivals(const std::vector<std::size_t>& bytes, int first,
                                         const VideoTiming& timing, const NetModel& net);

/// Bytes on the wire for one frame's pose going up, and around one frame coming down.
inline constexpr std::size_t kPoseBytes = 80;
inline constexpr std::size_t kVideoFraming = 28;

/// `shown` (RGBA8, seen by `then`) turned to the orientation of `now`, bilinear; where it has
/// nothing: black with alpha 255. `outside`: number of those pixels.
std::vector<std::uint8_t> timewarp(const std::vector<std::uint8_t>& shown, const Camera& then,
                                   const Camera& now, std::size_t& outside);

}  // namespace mirage
