#include "client/library/context_mark.h"

#include <atomic>

#include "shaders/gl/gl_object.h"

namespace mirage::library {
namespace {

constexpr int kMarks = 1 << 20;  // floats that count without rounding

float next_value() {
  static std::atomic<int> count{0};
  return -1001.0f - static_cast<float>(count++ % kMarks);  // GL's initial value is -1000
}

}  // namespace

bool any_context() { return glGetString(GL_VERSION) != nullptr; }

ContextMark::ContextMark() : value_(next_value()) {
  glGenSamplers(1, &sampler_);
  glSamplerParameterf(sampler_, GL_TEXTURE_MIN_LOD, value_);
}

ContextMark::~ContextMark() {
  if (!gl::ForgetNames::on() && any_context() && here()) glDeleteSamplers(1, &sampler_);
}

bool ContextMark::here() const {
  if (!any_context() || glIsSampler(sampler_) != GL_TRUE) return false;
  GLfloat found = 0;
  glGetSamplerParameterfv(sampler_, GL_TEXTURE_MIN_LOD, &found);
  return found == value_;
}

}  // namespace mirage::library
