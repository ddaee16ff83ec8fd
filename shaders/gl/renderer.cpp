#include "shaders/gl/renderer.h"

#include "shaders/gl/dialect.h"

namespace mirage::gl {

bool is_software(const std::string& renderer) {
  for (const char* name : {"llvmpipe", "softpipe", "SWR", "SwiftShader"}) {
    if (renderer.find(name) != std::string::npos) return true;
  }
  return false;
}

bool is_software() { return is_software(renderer_name()); }

GLenum color_format(bool blended) {
  return blended || is_software() ? GL_RGBA16F : GL_SRGB8_ALPHA8;
}

}  // namespace mirage::gl
