#pragma once
// What a session consists of. ClientSession hands it from stage to stage; nobody else sees it.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "client/ask/codec_choice.h"
#include "client/ask/scheduler.h"
#include "client/frame/reference_frame.h"
#include "client/hold/mesh_cache.h"
#include "client/hold/tile_cache.h"
#include "client/hold/upload_queue.h"
#include "client/link/link.h"
#include "client/plan/predictor.h"
#include "client/plan/scene_opener.h"
#include "client/plan/selector.h"
#include "client/scene/scene_view.h"
#include "client/session/session_options.h"
#include "client/session/shadow_stage.h"
#include "client/session/tile_sink.h"
#include "client/session/tile_tally.h"
#include "client/session/view_stage.h"

namespace mirage {

/// Time that never goes back, whatever the caller's clock does: pauses would never end, and no view
/// sample would be newer than the last.
class RisingTime {
 public:
  std::int64_t at(std::int64_t told_us) {
    if (told_us < told_us_) set_back_us_ += told_us_ - told_us;
    told_us_ = told_us;
    return told_us + set_back_us_;
  }

 private:
  std::int64_t told_us_ = INT64_MIN;  ///< when last asked
  std::int64_t set_back_us_ = 0;      ///< by how much it has been set back in all
};

struct SessionParts {
  SessionParts(Link& to, ClientOptions o, TileSink s)
      : link(to),
        options(std::move(o)),
        sink(std::move(s)),
        held(options),
        planning(options),
        asking(options) {}

  struct Connection {
    std::uint32_t generation = 0;
    std::int64_t greeted_us = 0;  ///< when the hello left
    std::string goodbye;
  };
  /// The server's scene is another than the one that is drawn.
  struct NewScene {
    bool awaited = false;       ///< nothing of it can be shown yet
    std::int64_t since_us = 0;  ///< while it is
  };
  struct Light {
    Lighting now;
    bool own = false;      ///< set here; otherwise the scene's
    bool changed = false;  ///< has ever been another than the first
    std::uint32_t id = 0;  ///< that the server knows it by
  };
  struct Held {
    explicit Held(const ClientOptions& o)
        : tiles(o.atlas_edge, o.atlas_layers),
          views(o.views && o.method.automatic && o.shadows),
          relight(o.relight),
          uploads(o.upload_budget_bytes) {}
    TileCache tiles;
    MeshCache meshes;
    ShadowStage shadows;
    ViewStage views;
    RelightPolicy relight;
    UploadQueue uploads;
  };
  struct Planning {
    explicit Planning(const ClientOptions& o)
        : tau(o.tau_px, o.targets), plan(o.frame_ms, o.samples) {}
    Predictor predictor{50};
    Selector selector;
    TauController tau;
    FramePlan plan;
    bool at_rest = false;
    bool rested = false;  ///< all that tau asks for has come, and the eye stands
  };
  struct Asking {
    explicit Asking(const ClientOptions& o) : codec_choice(o.codec) {}
    Scheduler scheduler;
    SceneOpener opener;
    CodecChoice codec_choice;
    TileCodec codec = TileCodec::kZstd;
  };
  struct Reference {
    std::optional<ReferenceFrame> frame;
    std::size_t asked_px = 0;
    bool refused = false;
  };

  Link& link;
  const ClientOptions options;
  TileSink sink;
  RisingTime clock;
  Connection connection;
  NewScene new_scene;
  SceneView scene;
  Light light;
  Held held;
  Planning planning;
  Asking asking;
  Reference reference;
  TileTally tally;
  std::uint64_t frame = 0;
  Camera camera;       ///< of the last frame
  double time_s = 0;   ///< of the animation, at the last frame
  bool moves = false;  ///< something of the scene is animated

  bool shadowed() const { return scene.shadows && options.shadows; }
  /// Tells the server of a light of this client's own.
  void send_lighting();
};

}  // namespace mirage
