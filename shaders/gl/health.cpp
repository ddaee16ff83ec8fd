#include "shaders/gl/health.h"

#include <cstdio>

#include "shaders/gl/gl_object.h"

namespace mirage::gl {
namespace {

const char* name_of(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "invalid enum";
    case GL_INVALID_VALUE:
      return "invalid value";
    case GL_INVALID_OPERATION:
      return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "invalid framebuffer operation";
    case GL_OUT_OF_MEMORY:
      return "out of memory";
    case GL_CONTEXT_LOST:
      return "context lost";
    default:
      return "an unknown error";
  }
}

}  // namespace

Result<void> check_health(const std::string& what) {
  if (glGetGraphicsResetStatus() != GL_NO_ERROR) {
    return make_error(ErrorId::kGraphicsGl, "the graphics device was reset at " + what);
  }
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return {};
  return make_error(ErrorId::kGraphicsGl,
                    std::string("GL says '") + name_of(error) + "' at " + what);
}

int exit_without_leaks(int code) {
  const int left = live_objects();
  if (left == 0) return code;
  std::fprintf(stderr, "error internal: %d GL objects were not released\n", left);
  return code == 0 ? static_cast<int>(ExitCode::kInternal) : code;
}

}  // namespace mirage::gl
