#pragma once
// Whether a frame would be the picture that is already there (numerics.md section 5, rule 20): all
// that drawing reads is compared with what it read last.

#include <vector>

#include "client/frame/draw_list.h"
#include "client/scene/scene_view.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"

namespace mirage {

class Stillness {
 public:
  /// Texels, geometry or a scene came or went, or the target's content is lost.
  void content_changed() { known_ = false; }
  /// Whether these inputs draw what the last ones did; remembers them. What holds the target must
  /// still have that picture.
  bool unchanged(const Camera& camera, const SceneView& scene, const DrawList& list,
                 const Lighting& lighting);

 private:
  bool known_ = false;
  std::vector<double> drawn_;  ///< camera and list, number by number
  CasterListPtr casters_;
  Lighting lighting_;
};

}  // namespace mirage
