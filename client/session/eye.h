#pragma once
// Eye: what planning remembers of one view from frame to frame. A frame of a window has one view;
// one for two eyes, or for a window in parts, has several. They share what is held, tau, the budget
// and the link.

#include <cstdint>
#include <memory>
#include <vector>

#include "client/plan/drawn_pixel.h"
#include "client/plan/predictor.h"
#include "client/plan/selector.h"
#include "client/scene/scene_view.h"

namespace mirage {

struct Eye {
  Predictor predictor{50};
  Selector selector;
  DrawnPixel drawn_pixel;
  bool rested = false;  ///< all that tau requires has arrived, and the eye is still
};

/// The eyes of the views of a frame, in their order; never empty.
class Eyes {
 public:
  Eyes() { resize(1, SceneView()); }

  std::size_t size() const { return eyes_.size(); }
  Eye& operator[](std::size_t view) { return *eyes_[view]; }
  const Eye& operator[](std::size_t view) const { return *eyes_[view]; }

  /// Adds or removes eyes at the end; `views` is above 0.
  void resize(std::size_t views, const SceneView& scene);
  /// Lets all of them begin anew with a scene.
  void reset(const SceneView& scene);
  /// Learns the instances that have arrived since.
  void grow(const SceneView& scene);
  /// Notes that a tile of the object has arrived.
  void note_tile(std::uint32_t object, double bytes);

 private:
  std::vector<std::unique_ptr<Eye>> eyes_;
};

}  // namespace mirage
