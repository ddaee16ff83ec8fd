#include "shaders/gl/view_depth.h"

#include <cstring>

namespace mirage::gl {
namespace {

bool has_clip_control() {
#ifdef GL_NEGATIVE_ONE_TO_ONE
  GLint major = 0, minor = 0, count = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  if (major * 10 + minor >= 45) return true;
  glGetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* name = glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i));
    if (std::strcmp(reinterpret_cast<const char*>(name), "GL_ARB_clip_control") == 0) return true;
  }
#endif
  return false;
}

}  // namespace

ViewDepth::ViewDepth()
    : mapping_(has_clip_control() ? DepthMapping::kReversed : DepthMapping::kForward) {
#ifdef GL_NEGATIVE_ONE_TO_ONE
  if (mapping_ == DepthMapping::kReversed) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
#endif
  glClearDepthf(farthest());
}

ViewDepth::~ViewDepth() {
#ifdef GL_NEGATIVE_ONE_TO_ONE
  if (mapping_ == DepthMapping::kReversed) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
#endif
  glClearDepthf(1.0f);
  glDepthFunc(GL_LESS);
}

GLenum nearer(DepthMapping mapping) {
  return mapping == DepthMapping::kReversed ? GL_GREATER : GL_LESS;
}

GLenum nearer_or_equal(DepthMapping mapping) {
  return mapping == DepthMapping::kReversed ? GL_GEQUAL : GL_LEQUAL;
}

}  // namespace mirage::gl
