#pragma once
// One client's session: the client stages in flow order, driven frame by frame.
//
//   link -> scene, tiles, meshes -> predictor -> selector -> scheduler, opener -> link
//
// No sockets, no windows, no clock of its own: time comes with every call.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/ask/codec_choice.h"
#include "client/ask/scheduler.h"
#include "client/frame/reference_frame.h"
#include "client/hold/mesh_cache.h"
#include "client/hold/upload_queue.h"
#include "client/link/link.h"
#include "client/plan/predictor.h"
#include "client/plan/relight_policy.h"
#include "client/plan/scene_opener.h"
#include "client/plan/selector.h"
#include "client/plan/tau_controller.h"
#include "client/scene/scene_view.h"
#include "client/session/shadow_stage.h"
#include "client/session/tile_trace.h"
#include "client/session/view_stage.h"
#include "protocol/clock.h"
#include "protocol/model_codec.h"

namespace mirage {

struct ClientOptions {
  double tau_px = 1;
  TauTargets targets;  ///< tau rises above tau_px while they are not met
  MethodChoice method;
  double frame_ms = 0;            ///< budget of a frame; 0: any time
  int samples = -1;               ///< of a pixel; < 0: as many as pay within the budget
  double march_budget_px = 1e9;   ///< screen area per frame drawn by marching depth
  double mesh_radii = kAnyRadii;  ///< nothing farther is drawn as geometry but what is cheap
  RelightChoice relight = RelightChoice::kAuto;
  int atlas_edge = 1024;
  int atlas_layers = 24;
  std::string token;
  std::string name = "mirage-view";
  std::size_t max_mesh_bytes = 64u << 20;      ///< of one reply, decompressed
  std::size_t mesh_budget_bytes = 256u << 20;  ///< graphics memory for geometry and its images
  std::size_t upload_budget_bytes = 8u << 20;  ///< to graphics memory in a frame
  bool trace = false;                          ///< keep every tile's life
  /// The session's clock, for the trace, where time passes within a frame; empty: it does not.
  std::function<std::int64_t()> trace_clock = nullptr;
  bool shadows = true;             ///< the sun's, if the server has them
  bool animation = true;           ///< false: every clip stands at its beginning
  std::optional<TileCodec> codec;  ///< of tiles; none: by link and cost
  bool views = true;  ///< a view tile shows what has no image yet (automatic methods, with
                      ///< what shadows the server draws)
  Camera screen;      ///< of the first frames: size and field of view
};

/// Where decoded pixels and meshes go; the frame renderer implements it.
struct TileSink {
  std::function<void(const TileRecord&, const TilePixels&)> tile;
  std::function<void(const ShadowRecord&, const std::vector<std::uint8_t>&)> shadow, caster;
  std::function<void(std::uint32_t object, std::uint8_t lod, ObjectModel)> mesh;
  std::function<void(std::uint32_t index, const Image&)> image;
  std::function<void(const AssetId&)> drop;  ///< an image that goes shows its mean colour again
  std::function<void(const SceneView&)> scene;
  std::function<void(const ViewTile&)> view;
};

struct TileCounts {
  std::uint64_t asked = 0, received = 0, drawn = 0, wasted = 0, cancelled = 0, refused = 0;
};

/// Of the tiles that came in one codec.
struct CodecUse {
  std::uint64_t tiles = 0;
  std::uint64_t bytes = 0;       ///< of their planes
  std::vector<float> color_rms;  ///< of lossy ones, each tile's, 1/255
  std::uint8_t color_max = 0;    ///< of any texel, 1/255
};
using CodecUses = std::array<CodecUse, kCodecNumbers>;

class ClientSession {
 public:
  ClientSession(Link& link, ClientOptions options, TileSink sink);

  /// Takes in what has arrived. Says hello on every new connection. An error is for the log: the
  /// session goes on with what it has.
  Result<void> receive(std::int64_t now_us);
  /// Plans one frame: what to draw, with the true camera; sends what is to be asked for. The
  /// session's clock is the animation's.
  DrawList frame(const Camera& camera, std::int64_t now_us);

  /// What this device takes for what, for the plan of the frames to come.
  void set_prices(const CostModel& prices) { plan_.set_prices(prices); }
  /// The frame planned last took so long to draw, by the clock or by those prices.
  void note_frame_ms(double ms) { plan_.note_drawn(ms); }
  /// How the frame is to be drawn that was planned last, and what it is expected to take.
  const FramePlan& plan() const { return plan_; }
  /// What was considered for it, and chosen.
  const Selector& selector() const { return selector_; }
  double tau_px() const { return tau_.tau_px(); }

  void set_lighting(const Lighting& lighting, std::int64_t now_us);
  /// Whether the light has ever been another than the first.
  bool light_changed() const { return light_changed_; }
  /// Asks for a full render of this camera; it arrives as reference().
  void ask_reference(const Camera& camera, std::uint32_t supersample);
  std::optional<ReferenceFrame> take_reference() { return std::exchange(reference_, std::nullopt); }
  bool reference_refused() const { return reference_refused_; }

  const SceneView& scene() const { return scene_; }
  const Lighting& lighting() const { return lighting_; }
  const Predictor& predictor() const { return predictor_; }
  TileCounts tiles() const;
  /// By codec, of all tiles that were decoded.
  const CodecUses& codecs() const { return codec_uses_; }
  /// That tiles are asked for in now.
  TileCodec codec() const { return codec_; }
  const UploadCounts& uploads() const { return uploads_.counts(); }
  const std::vector<TileLife>& lives() const { return trace_.lives(); }
  /// The frame planned last is drawn. For the trace.
  void note_drawn(std::int64_t now_us) { trace_.frame_drawn(now_us); }
  const ViewCounts& views() const { return views_.counts(); }
  /// There is something to draw: the scene, or a view of it.
  bool drawable() const { return scene_.complete() || (scene_.welcomed() && views_.here()); }
  std::int64_t round_trip_us() const { return scheduler_.round_trip_us(); }
  /// Something in view lacks an image of its own, and asking for it waits for the link or the
  /// server.
  bool first_waits() const { return scheduler_.first_waits(); }
  std::size_t in_flight() const { return scheduler_.in_flight(); }
  /// Nothing was left to ask for in the last frame, nothing is under way, nothing moves: until the
  /// camera, the light or the link brings something new, further frames would do nothing.
  bool at_rest() const { return at_rest_; }
  std::uint64_t frame_number() const { return frame_; }
  const std::string& goodbye() const { return goodbye_; }

 private:
  Result<void> handle(Message message, std::int64_t now_us);
  /// Bytes of graphics memory a reply will fill, as far as it tells.
  std::size_t upload_cost(const Message& message) const;
  /// It is a picture of what shows none yet.
  bool first_image(const Message& message) const;
  /// Of the scene; one that comes before its turn waits for it.
  Result<void> take_page(Message page);
  /// The scene is there, or has grown.
  void take_scene(bool was_complete);
  /// `came_us`: when the link had it.
  Result<void> take_tile(const wire::TileReplyT& reply, const Bytes& planes, std::int64_t came_us,
                         std::int64_t now_us);
  Result<void> finish_asset(std::uint32_t request_id, const AssetId& id, std::size_t bytes,
                            std::int64_t came_us);
  void take_shadow(const PendingAsk& ask, const Capture& capture, const Tile& tile);
  Result<void> decode(const wire::TileReplyT& reply, const Bytes& planes, Tile& tile);
  Result<void> take_mesh(const wire::MeshReplyT& reply, const Bytes& bytes, std::int64_t came_us,
                         std::int64_t now_us);
  Result<void> take_image(const wire::ImageReplyT& reply, const Bytes& bytes, std::int64_t came_us,
                          std::int64_t now_us);
  Result<void> take_view(const wire::ViewReplyT& reply, const Bytes& bytes, std::int64_t came_us);
  Result<void> take_reference(const wire::ReferenceReplyT& reply, const Bytes& bytes);
  void take_refusal(const wire::RefusedT& refused, std::int64_t now_us);
  // The stages of a frame, in their order; shading is ShadowStage's, between planning and asking.
  struct Predicted {
    SelectorInput input;
    bool stands = false;   ///< the eye stays, here and ahead
    bool passing = false;  ///< relit tiles are shown for now
  };
  struct Needs {
    std::vector<TileNeed> tiles;
    std::vector<AssetNeed> meshes;
  };
  Predicted predict(const Camera& camera, std::int64_t now_us);
  DrawList plan(const SelectorInput& input);
  Needs ask(const SelectorInput& input);
  void send(const Predicted& at, const DrawList& list, Needs needs);
  bool shadowed() const { return scene_.shadows && options_.shadows; }
  /// Tiles that this frame draws for the first time.
  void note_first_drawn(std::int64_t now_us);
  void greet(std::int64_t now_us);
  void send_lighting();
  /// Time that never goes back, whatever the caller's clock does: pauses would never end, and no
  /// view sample would be newer than the last.
  std::int64_t steady_us(std::int64_t now_us);

  Link& link_;
  const ClientOptions options_;
  TileSink sink_;
  std::uint32_t generation_ = 0;
  std::int64_t greeted_us_ = 0;  ///< when the hello left
  SceneView scene_;
  std::vector<Message> early_pages_;  ///< of the scene, before their turn
  Lighting lighting_;
  bool own_lighting_ = false;
  bool light_changed_ = false;
  std::uint32_t lighting_id_ = 0;
  TileCache cache_;
  RelightPolicy relight_;
  Predictor predictor_{50};
  Selector selector_;
  ShadowStage shadows_;
  SceneOpener opener_;
  Scheduler scheduler_;
  UploadQueue uploads_;
  ViewStage views_;
  TauController tau_;
  FramePlan plan_;
  CodecChoice codec_choice_;
  TileCodec codec_ = TileCodec::kZstd;
  CodecUses codec_uses_;
  MeshCache meshes_;
  std::optional<ReferenceFrame> reference_;
  std::size_t reference_asked_px_ = 0;
  bool reference_refused_ = false;
  bool moves_ = false;  ///< something of the scene is animated
  bool at_rest_ = false;
  bool rested_ = false;               ///< all that tau asks for has come, and the eye stands
  std::int64_t told_us_ = INT64_MIN;  ///< the caller's clock, when it was last told
  std::int64_t set_back_us_ = 0;      ///< by how much it has been set back in all
  std::uint64_t frame_ = 0;
  double time_s_ = 0;  ///< of the animation, at the last frame
  std::uint64_t received_ = 0;
  std::uint64_t refused_ = 0;
  /// A tile that has come and was not drawn yet.
  struct Undrawn {
    std::weak_ptr<const TileRecord> tile;
    std::size_t life = SIZE_MAX;  ///< its place in the trace, if one is kept
  };
  std::vector<Undrawn> undrawn_;
  std::uint64_t drawn_ = 0;
  TileTrace trace_;
  std::string goodbye_;
};

}  // namespace mirage
