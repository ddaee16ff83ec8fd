#pragma once
// Session parts: what a session consists of. ClientSession hands it from stage to stage; nobody
// else sees it.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/ask/answered_keys.h"
#include "client/ask/catalogue.h"
#include "client/ask/codec_choice.h"
#include "client/ask/scheduler.h"
#include "client/frame/reference_frame.h"
#include "client/hold/mesh_cache.h"
#include "client/hold/tile_cache.h"
#include "client/hold/upload_queue.h"
#include "client/link/link.h"
#include "client/plan/alternatives.h"
#include "client/plan/frame_plan.h"
#include "client/plan/scene_opener.h"
#include "client/scene/ground_map.h"
#include "client/scene/scene_view.h"
#include "client/session/eye.h"
#include "client/session/ground_asks.h"
#include "client/session/playback.h"
#include "client/session/session_options.h"
#include "client/session/shadow_stage.h"
#include "client/session/tile_sink.h"
#include "client/session/tile_tally.h"
#include "client/session/view_stage.h"

namespace mirage {

/// Time that never runs backwards, even if the caller's clock does. Otherwise pauses would never
/// end, and no view sample would be newer than the last.
class RisingTime {
 public:
  std::int64_t at(std::int64_t told_us) {
    if (told_us < told_us_) set_back_us_ += told_us_ - told_us;
    told_us_ = told_us;
    return told_us + set_back_us_;
  }

 private:
  std::int64_t told_us_ = INT64_MIN;  ///< time that was last passed in
  std::int64_t set_back_us_ = 0;      ///< sum of all steps back
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
    std::uint32_t welcomes = 0;   ///< taken in so far, of all connections
    std::int64_t greeted_us = 0;  ///< when the hello was sent
    std::string goodbye;
  };
  /// The server's scene differs from the one that is drawn.
  struct NewScene {
    bool awaited = false;       ///< nothing of the new scene can be shown yet
    std::int64_t since_us = 0;  ///< when the wait began
  };
  struct Light {
    Lighting now;
    bool own = false;      ///< set by this client; otherwise the scene's
    bool changed = false;  ///< it has ever differed from the first
    std::uint32_t id = 0;  ///< number by which the server knows it
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
    GroundMap ground;
    ViewStage views;
    RelightPolicy relight;
    UploadQueue uploads;
  };
  struct Planning {
    explicit Planning(const ClientOptions& o)
        : tau(o.tau_px, o.targets), plan(o.frame_ms, o.samples) {}
    Eyes eyes;
    TauController tau;
    FramePlan plan;
    std::vector<Alternatives> things;  ///< of the last frame, view by view
    bool at_rest = false;
  };
  struct Asking {
    explicit Asking(const ClientOptions& o) : codec_choice(o.codec) {}
    Scheduler scheduler;
    AnsweredKeys answered;
    Catalogue catalogue;
    SceneOpener opener;
    GroundAsks ground;
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
  SceneChoice choice = options.choice;  ///< of the next hello
  std::string token = options.token;    ///< the same
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
  std::optional<Pose> start;  ///< pose of the first frames; none: the scene's home view
  Camera camera;              ///< camera of the first view of the last frame
  Playback playback;
  double time_s = 0;   ///< time of the animation in the last frame
  bool moves = false;  ///< some object of the scene is animated

  /// True if the picture changes by itself.
  bool animates() const { return may_animate() && playback.playing(); }
  /// True if something moves by itself, unless it is stopped.
  bool may_animate() const { return moves && options.animation && !asking.catalogue.there(); }
  bool shadowed() const { return scene.shadows && options.shadows; }
  /// Tells the server about this client's own light.
  void send_lighting();
};

}  // namespace mirage
