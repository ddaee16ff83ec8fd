#pragma once
// Depth of camera pictures: reversed and without a far plane if the context has glClipControl, else
// forward (GLES 3.0).

#include "protocol/impostor/camera.h"
#include "shaders/gl/gl.h"

namespace mirage::gl {

/// While it exists, the context clips and clears for its best mapping; afterwards GL's initial
/// state is restored. The depth attachment should be a float one.
class ViewDepth {
 public:
  ViewDepth();
  ~ViewDepth();
  ViewDepth(const ViewDepth&) = delete;
  ViewDepth& operator=(const ViewDepth&) = delete;

  DepthMapping mapping() const { return mapping_; }
  /// Returns the depth that glClear writes, which is the farthest.
  float farthest() const { return mapping_ == DepthMapping::kReversed ? 0.0f : 1.0f; }

 private:
  DepthMapping mapping_;
};

/// The depth functions that keep nearer surfaces, or also equally near ones.
GLenum nearer(DepthMapping mapping);
GLenum nearer_or_equal(DepthMapping mapping);

}  // namespace mirage::gl
