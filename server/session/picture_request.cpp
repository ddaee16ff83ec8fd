#include "server/session/picture_request.h"

#include <fmt/format.h>

namespace mirage {

// Numbers are written so that they read back as the same value.
std::string PictureRequest::key() const {
  std::string out = fmt::format("{}x{} {} {} {}", camera.width, camera.height, samples,
                                static_cast<int>(format), camera.fov_y);
  const glm::quat& q = camera.pose.rotation;
  const glm::dvec3& eye = camera.pose.eye;
  if (most_bytes > 0) out += fmt::format(" in {}", most_bytes);
  if (posed)
    out += fmt::format(" at {} {} {} {} {} {} {}", eye.x, eye.y, eye.z, q.w, q.x, q.y, q.z);
  if (sun) out += fmt::format(" sun {} {}", sun->azimuth, sun->elevation);
  return out;
}

}  // namespace mirage
