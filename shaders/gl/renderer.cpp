#include "shaders/gl/renderer.h"

#include <cstring>

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

#ifdef __EMSCRIPTEN__

bool has_sample_shading() { return false; }
void let_shaders_size_points() {}

#else

bool has_sample_shading() {
  if (is_embedded()) return false;
  GLint major = 0, count = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  if (major >= 4) return true;
  glGetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* name = glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i));
    if (std::strcmp(reinterpret_cast<const char*>(name), "GL_ARB_sample_shading") == 0) return true;
  }
  return false;
}

void let_shaders_size_points() {
  if (!is_embedded()) glEnable(GL_PROGRAM_POINT_SIZE);
}

#endif

}  // namespace mirage::gl
