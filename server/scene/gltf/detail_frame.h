#pragma once
// The frame of a home view: the part of a scene that carries most of its detail. A sky ball around
// a model, or a stray triangle far away, would make everything else a dot.

#include <cstddef>
#include <string>
#include <vector>

#include "server/scene/gltf/bounds.h"

namespace mirage::gltf {

struct DetailFrame {
  Bounds bounds;                         ///< what is framed; `all` if nothing is left out
  std::vector<std::string> surrounding;  ///< names of objects around everything else
  double far_share = 0;                  ///< of the triangles: left out since they are far away

  bool leaves_out() const { return !surrounding.empty() || far_share > 0; }
  /// One line for the log; empty if nothing is left out.
  std::string told() const;
};

/// Returns what to frame of a scene within `all`. Objects that hold everything else in a hollow of
/// four times its size are left out. Of the rest, the frame is taken in which most triangles would
/// be seen, if that is much smaller: a fiftieth, or a quarter with only a hundredth of the
/// triangles outside.
DetailFrame frame_detail(const Scene& scene, const Bounds& all);

}  // namespace mirage::gltf
