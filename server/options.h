#pragma once
#include <optional>
#include <string>

#include "protocol/model/scene_types.h"
#include "protocol/model/view_place.h"
#include "server/base/log.h"
#include "server/net/endpoint_options.h"
#include "server/session/session_options.h"
#include "server/source/store_url.h"
#include "server/stage/render_options.h"

namespace mirage {

struct ServerOptions {
  std::string scene;
  SceneChoice choice;             ///< instead of what `scene` names
  std::size_t choices = 4;        ///< scenes with another choice, beside that one
  std::string environment;        ///< empty: what suits the scene
  std::string look = "studio";    ///< or "plain"
  std::optional<ViewPlace> home;  ///< nullopt: the scene's own home view
  std::string write_environment;  ///< set: only write it to this file
  EndpointOptions endpoint;
  RenderOptions render;
  SessionOptions session;
  std::string token_file;  ///< empty: no client needs a token
  std::string port_file;
  std::string cache_dir;
  std::uint64_t cache_dir_mb = 4096;
  bool cache_read_only = false;
  std::size_t cache_mb = 512;
  std::uint64_t scene_mb = 0;         ///< memory that the scene may take
  std::optional<StoreAddress> store;  ///< that servers share
  int encoders = 0;                   ///< 0: as many as suit the machine
  bool strict = false;                ///< refuse what viewers forgive
  bool shadows = false;               ///< asked for; a scene without casters has none all the same
  bool list_devices = false;
  bool require_gpu = false;   ///< refuse to draw on the CPU
  bool check_config = false;  ///< only read the configuration and the scene
  bool doctor = false;        ///< only look whether this machine can serve
  LogFormat log_format = LogFormat::kText;
  bool explain = false;
  bool prove = false;  ///< with explain: draw both ways and compare
  int prove_cells = 26;
  int prove_objects = 3;  ///< of objects that have the same left out
  bool json = false;
};

/// Reads the command line; returns an exit code when the program is to end at once, else -1.
int parse_options(int argc, char** argv, ServerOptions& options);

}  // namespace mirage
