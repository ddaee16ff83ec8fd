#include "shaders/gl/view_depth.h"

#include "shaders/gl/dialect.h"

namespace mirage::gl {

ViewDepth::ViewDepth()
    : mapping_(has_clip_control() ? DepthMapping::kReversed : DepthMapping::kForward) {
  if (mapping_ == DepthMapping::kReversed) set_clip_depth_zero_to_one(true);
  glClearDepthf(farthest());
}

ViewDepth::~ViewDepth() {
  if (mapping_ == DepthMapping::kReversed) set_clip_depth_zero_to_one(false);
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
