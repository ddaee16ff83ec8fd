#pragma once
// A depth map of casters as seen from the sun. Uses only the GLES 3.0 subset.

#include "protocol/base/result.h"
#include "protocol/impostor/sun_frame.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage::gl {

class ShadowMap {
 public:
  ShadowMap() = default;
  /// Creates a map of `edge` texels a side. Error kGraphicsGl.
  static Result<ShadowMap> create(int edge);

  /// Clears the map and binds it for drawing casters with `frame`, whose edge must be the map's.
  void begin(const SunFrame& frame);
  /// Passes the map to a program that includes common/shadow.glsl; positions are relative to `eye`.
  void use(Program& program, const glm::dvec3& eye) const;

  int edge() const { return edge_; }
  const SunFrame& frame() const { return frame_; }
  std::size_t gpu_bytes() const {
    return 2 * static_cast<std::size_t>(edge_) * static_cast<std::size_t>(edge_);
  }

 private:
  Texture depth_;
  Framebuffer framebuffer_;
  SunFrame frame_;
  int edge_ = 0;
};

}  // namespace mirage::gl
