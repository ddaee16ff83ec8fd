#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "client/frame/method_choice.h"
#include "client/plan/relight_policy.h"
#include "client/plan/tau_controller.h"
#include "protocol/codec/codec_id.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"

namespace mirage {

struct ClientOptions {
  double tau_px = 1;
  TauTargets targets;  ///< tau rises above tau_px while they are not met
  MethodChoice method;
  double frame_ms = 0;            ///< budget of a frame; 0: any time
  int samples = -1;               ///< samples per pixel; < 0: chosen by the frame plan
  double march_budget_px = 1e9;   ///< screen area per frame drawn by marching depth
  double mesh_radii = kAnyRadii;  ///< farther than this, only cheap objects are geometry
  /// Ask for geometry wherever the scene has some, whatever tiles would cost.
  bool geometry_first = false;
  RelightChoice relight = RelightChoice::kAuto;
  int atlas_edge = 1024;
  int atlas_layers = 24;
  std::string token;
  std::string name = "mirage-view";
  SceneChoice choice;                          ///< to ask for at first
  std::size_t max_mesh_bytes = 64u << 20;      ///< of one reply, decompressed
  std::size_t mesh_budget_bytes = 256u << 20;  ///< graphics memory for geometry and its images
  std::size_t upload_budget_bytes = 8u << 20;  ///< to graphics memory in a frame
  bool trace = false;                          ///< keep every tile's life
  /// The session's clock, for the trace. Needed only where time passes within a frame.
  std::function<std::int64_t()> trace_clock = nullptr;
  bool shadows = true;             ///< draw the sun's shadows, if the server has them
  bool animation = true;           ///< false: every clip stands at its beginning
  std::optional<TileCodec> codec;  ///< codec of tiles; none: by link and cost
  /// Show a view tile where an object has no image yet. Needs automatic methods, and shadows as the
  /// server draws them.
  bool views = true;
  Camera screen;  ///< size and field of view of the first frames
};

}  // namespace mirage
