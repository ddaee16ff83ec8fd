#pragma once
// Context mark: an object in a GL context by which that context is known again.
// Thread: the GL thread.

#include "shaders/gl/gl.h"

namespace mirage::library {

class ContextMark {
 public:
  /// Marks the current context.
  ContextMark();
  /// Unmarks it, if it is current and the names are not forgotten (gl::ForgetNames).
  ~ContextMark();
  ContextMark(const ContextMark&) = delete;
  ContextMark& operator=(const ContextMark&) = delete;

  /// True if the marked context is current, or one that shares its objects.
  bool here() const;

 private:
  GLuint sampler_ = 0;
  float value_ = 0;  ///< of its least level of detail; no other client's
};

/// True if some context is current.
bool any_context();

}  // namespace mirage::library
