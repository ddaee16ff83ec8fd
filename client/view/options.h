#pragma once
#include <optional>
#include <string>

#include "client/frame/method_choice.h"
#include "client/link/modelled_link.h"
#include "client/plan/relight_policy.h"
#include "client/plan/tau_controller.h"
#include "client/price/cost_model.h"
#include "protocol/model/scene_types.h"

namespace mirage {

/// Settings for drawing without a display.
struct Offscreen {
  std::string device = "auto";  ///< EGL device
  bool gles = false;            ///< OpenGL ES 3, as in a browser
};

/// When a run ends.
struct RunLength {
  int frames = 0;      ///< 0: until closed (window) or 300 (offscreen)
  double seconds = 0;  ///< of the session's time; 0: no limit
};

/// Settings of the scene that is shown.
struct SceneOptions {
  SceneChoice choice;  ///< clip and variant
  std::string animation = "on";
  std::string shadows = "on";
};

struct ViewOptions {
  std::string url;
  bool offscreen = false;
  bool views = true;  ///< view tiles where objects have no image yet
  int width = 1280, height = 720;
  std::string path;  ///< empty: mouse and keyboard (window), or the walk (offscreen)
  std::string light = "builtin:fixed";
  std::string relight_name = "auto";
  RelightChoice relight = RelightChoice::kAuto;
  RunLength length;
  double fps = 60;
  double fov_degrees = 60;
  bool virtual_time = false;
  std::optional<NetModel> net;
  std::string device_model_name;  ///< empty: frames take no virtual time
  std::optional<CostModel> device_model;
  double frame_ms = -1;  ///< budget of a frame; 0: none; < 0: by renderer and display
  double tau_px = 1;
  TauTargets targets;
  std::string method_name = "auto";
  MethodChoice method;
  int reference_every = 0;
  int reference_supersample = 2;
  std::string msaa_name = "auto";
  int msaa = -1;  ///< samples of a pixel; < 0: as many as pay within the budget
  int atlas_mb = 216;
  int mesh_mb = 256;
  int upload_kb = 8192;
  double mesh_radii = kAnyRadii;
  double march_kpx = -1;  ///< thousand px a frame drawn by marching, at most; < 0: any
  std::string out_dir;
  std::string explain_file;
  std::string stats_file;
  std::string trace_file;
  SceneOptions scene;
  std::string codec_name = "auto";
  std::string ca_file;
  std::string token_file;
  std::string token;
  Offscreen graphics;
  double connect_timeout_s = 10;
};

/// Reads the command line. Returns an exit code if the program should end at once, otherwise -1.
int parse_options(int argc, char** argv, ViewOptions& options);

}  // namespace mirage
