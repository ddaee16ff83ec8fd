#pragma once
// Depth of pictures taken by a camera: reversed and without a far end where the context has
// glClipControl, forward where it does not (GLES 3.0).

#include "protocol/impostor/camera.h"
#include "shaders/gl/gl.h"

namespace mirage::gl {

/// While it lives, the context clips and clears for the best mapping it has; then as GL starts. The
/// attachment should be a float one.
class ViewDepth {
 public:
  ViewDepth();
  ~ViewDepth();
  ViewDepth(const ViewDepth&) = delete;
  ViewDepth& operator=(const ViewDepth&) = delete;

  DepthMapping mapping() const { return mapping_; }
  /// What glClear leaves behind: the farthest depth there is.
  float farthest() const { return mapping_ == DepthMapping::kReversed ? 0.0f : 1.0f; }

 private:
  DepthMapping mapping_;
};

/// The depth function that keeps what is nearer, or also what is as near.
GLenum nearer(DepthMapping mapping);
GLenum nearer_or_equal(DepthMapping mapping);

}  // namespace mirage::gl
