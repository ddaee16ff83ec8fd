#pragma once
// Selector input: all that is known of a view when it is decided what to draw and what to ask for.

#include <cstdint>
#include <limits>
#include <vector>

#include "client/frame/method_choice.h"
#include "protocol/impostor/camera.h"

namespace mirage {

class FramePlan;
class MeshCache;
class SceneView;
class TileBytes;
class TileCache;
class ViewFit;

struct SelectorInput {
  const SceneView* scene = nullptr;
  const TileCache* cache = nullptr;
  const std::vector<bool>* mesh_ready = nullptr;  ///< by object
  const MeshCache* meshes = nullptr;              ///< nullptr: resident geometry counts as exact
  const TileBytes* tile_bytes = nullptr;          ///< nullptr: a usual number of bytes
  const ViewFit* view = nullptr;                  ///< fit of the view tile; nullptr: there is none
  const FramePlan* plan = nullptr;                ///< never null: what error is worth
  Camera camera;
  Camera predicted;
  glm::dvec3 velocity{0};  ///< velocity of the eye, world space, m/s
  double tau_px = 1;
  double mesh_tau_px = 1;  ///< tau for choosing levels of geometry
  double pixel_px = 1;     ///< size of a drawn pixel on the shown picture (drawn_pixel.h)
  /// Value that tau was steered up from. Tau rises last where the viewer looks.
  double target_px = std::numeric_limits<double>::infinity();
  MethodChoice method;
  double march_budget_px = 1e9;   ///< screen area that may be drawn by marching depth
  double mesh_radii = kAnyRadii;  ///< farther than this, only cheap objects are geometry
  bool geometry_first = false;    ///< geometry wherever there is some, whatever tiles cost
  std::uint64_t frame = 0;
  std::int64_t now_us = 0;
  double spare_bytes =
      0;                 ///< bytes that the link would bring in a moment, beside what is asked for
  double time_s = 0;     ///< present time of the animation
  double lead_s = 0;     ///< time until an asked tile is here; 0: the animation stands still
  double horizon_s = 0;  ///< time that phases are asked for ahead, >= lead_s
};

}  // namespace mirage
