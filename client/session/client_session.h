#pragma once
// One client's session: the client stages in flow order, driven frame by frame.
//
//   link -> scene, tiles, meshes -> predictor -> selector -> scheduler, opener -> link
//
// No sockets, no windows, no clock of its own: time comes with every call.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/frame/draw_list.h"
#include "client/frame/reference_frame.h"
#include "client/session/counts.h"
#include "client/session/session_options.h"
#include "client/session/tile_sink.h"
#include "protocol/base/result.h"

namespace mirage {

class Arrivals;
class FramePlan;
class Link;
class Predictor;
class SceneView;
class Selector;
struct CostModel;
struct SessionParts;
struct TileLife;
struct UploadCounts;
struct ViewCounts;

class ClientSession {
 public:
  ClientSession(Link& link, ClientOptions options, TileSink sink);
  ~ClientSession();

  /// Takes in what has arrived. Says hello on every new connection. An error is for the log: the
  /// session goes on with what it has.
  Result<void> receive(std::int64_t now_us);
  /// Plans one frame: what to draw, with the true camera; sends what is to be asked for. The
  /// session's clock is the animation's.
  DrawList frame(const Camera& camera, std::int64_t now_us);

  /// What this device takes for what, for the plan of the frames to come.
  void set_prices(const CostModel& prices);
  /// The frame planned last took so long to draw, by the clock or by those prices.
  void note_frame_ms(double ms);
  /// How the frame is to be drawn that was planned last, and what it is expected to take.
  const FramePlan& plan() const;
  /// What was considered for it, and chosen.
  const Selector& selector() const;
  double tau_px() const;

  void set_lighting(const Lighting& lighting, std::int64_t now_us);
  /// Whether the light has ever been another than the first.
  bool light_changed() const;
  /// Asks for a full render of this camera; it arrives as reference().
  void ask_reference(const Camera& camera, std::uint32_t supersample);
  std::optional<ReferenceFrame> take_reference();
  bool reference_refused() const;

  const SceneView& scene() const;
  const Lighting& lighting() const;
  const Predictor& predictor() const;
  TileCounts tiles() const;
  /// By codec, of all tiles that were decoded.
  const CodecUses& codecs() const;
  /// That tiles are asked for in now.
  TileCodec codec() const;
  const UploadCounts& uploads() const;
  const std::vector<TileLife>& lives() const;
  /// The frame planned last is drawn. For the trace.
  void note_drawn(std::int64_t now_us);
  const ViewCounts& views() const;
  /// There is something to draw: the scene, or a view of it.
  bool drawable() const;
  /// The server has another scene now, and there is nothing to show of it yet: what was drawn last
  /// is better than what frame() lists.
  bool awaits_new_scene() const;
  std::int64_t round_trip_us() const;
  /// Something in view lacks an image of its own, and asking for it waits for the link or the
  /// server.
  bool first_waits() const;
  std::size_t in_flight() const;
  /// Nothing was left to ask for in the last frame, nothing is under way, nothing moves: until the
  /// camera, the light or the link brings something new, further frames would do nothing.
  bool at_rest() const;
  std::uint64_t frame_number() const;
  const std::string& goodbye() const;

 private:
  std::unique_ptr<SessionParts> parts_;
  std::unique_ptr<Arrivals> arrivals_;
};

}  // namespace mirage
