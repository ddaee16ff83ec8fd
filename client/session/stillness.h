#pragma once
// Stillness: tells whether a frame would be the picture that is already there (numerics.md section
// 5, rule 20). It compares everything that drawing reads with the last time.

#include <vector>

#include "client/frame/planned_frame.h"

namespace mirage {

class Stillness {
 public:
  /// Notes that texels, geometry or a scene came or went, or that the target's content is lost.
  void content_changed() { known_ = false; }
  /// True if these inputs draw the same picture as the last ones; remembers them. The target must
  /// still hold that picture.
  bool unchanged(const PlannedFrame& frame);

 private:
  bool known_ = false;
  std::vector<double> drawn_;  ///< camera and list, number by number
  CasterListPtr casters_;
  Lighting lighting_;
};

}  // namespace mirage
