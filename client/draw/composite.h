#pragma once
// Composite: lays a finished picture into the framebuffer of somebody else, by depth.
// Input:  a picture with its depth; how the framebuffer keeps colour and depth.
// Output: colour and depth of that framebuffer.
// Thread: the GL thread.
// Full:   never.

#include <cstdint>
#include <glm/glm.hpp>

#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

struct Camera;
class FrameTarget;

/// How a framebuffer keeps depth, with a depth range from 0 to 1.
struct HostDepth {
  glm::dvec2 window{0};   ///< window depth = x + y / eye depth, unless it is logarithmic
  double log_factor = 0;  ///< window depth = log_factor * log2(1 + eye depth); 0: it is not
  bool reversed = false;  ///< 1 is nearest
};

/// How a framebuffer keeps colour.
enum class HostColor : std::uint8_t {
  kEncodedByHardware,  ///< an sRGB format: it encodes what shaders write, and blends linear light
  kEncodedByShader,    ///< sRGB values in a format that knows nothing of it
  kLinear,
};

/// A framebuffer of somebody else, and the place of the picture in it.
struct HostTarget {
  GLuint framebuffer = 0;
  int x = 0, y = 0;  ///< lower left corner, px
  HostColor color = HostColor::kEncodedByShader;
  bool depth = true;  ///< the picture is tested against the depth that is there, and writes its own
  HostDepth host;
};

class Composite {
 public:
  /// Error kGraphicsShader.
  static Result<Composite> create();

  /// Draws `picture`, seen by `camera` (of its size). `metre`: lengths of the framebuffer's depth
  /// over those of the scene. `background`: the picture has one. Error kGraphicsGl. It leaves the
  /// framebuffer bound, the viewport on the picture's place, and no depth test.
  Result<void> draw(const FrameTarget& picture, const Camera& camera, double metre, bool background,
                    const HostTarget& target);

 private:
  gl::Program program_;
  gl::VertexArray vao_;
};

}  // namespace mirage
