#pragma once
// Client session: the client stages in flow order, driven frame by frame.
// Input:  the camera and the time, frame by frame; messages from the link.
// Output: the draw list of each frame; asks, on the link.
// Thread: the frame loop's.
// Full:   never; the parts behind it have their own limits.
//
//   link -> scene, tiles, meshes -> predictor -> selector -> scheduler, opener -> link
//
// It has no sockets, no windows and no clock of its own: the time comes with every call.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/session/counts.h"
#include "protocol/base/result.h"

namespace mirage {

class Arrivals;
class FramePlan;
class GroundMap;
class Link;
class Predictor;
class SceneView;
struct Alternatives;
struct Camera;
struct ClientOptions;
struct CostModel;
struct DrawList;
struct Lighting;
struct PlannedFrame;
struct Pose;
struct ReferenceFrame;
struct SceneChoice;
struct SessionParts;
struct TileLife;
struct TileSink;
struct UploadCounts;
struct ViewCounts;

class ClientSession {
 public:
  ClientSession(Link& link, ClientOptions options, TileSink sink);
  ~ClientSession();

  /// Takes in what has arrived, and sends a hello on every new connection. An error is for the log:
  /// the session goes on with what it has.
  Result<void> receive(std::int64_t now_us);
  /// Plans a frame of one or several views: returns what to draw with each of these true cameras,
  /// and sends asks. All views share the frame's budget; a view tile is asked for where the first
  /// one needs it. The session's clock is the animation's, too. The result refers to scene().
  std::vector<PlannedFrame> frame(const std::vector<Camera>& views, std::int64_t now_us);
  PlannedFrame frame(const Camera& camera, std::int64_t now_us);

  /// Sets the prices of this device, for planning later frames.
  void set_prices(const CostModel& prices);
  /// Sets the budget of later frames, ms; 0: any time.
  void set_frame_ms(double ms);
  /// Notes how long the last planned frame took to draw, by the clock or by those prices, and how
  /// long all else of it took.
  void note_frame_ms(double ms, double beside_ms = 0);
  /// Returns how the last planned frame is to be drawn, and its expected time.
  const FramePlan& plan() const;
  /// Returns what was considered for that frame: each visible thing of each view, in the order of
  /// FramePlan::choices().
  const std::vector<Alternatives>& considered() const;
  double tau_px() const;

  /// Tells where the eye starts, before the session connects, for whoever comes by a link to a
  /// place: the first picture is seen from there, and not from the scene's home.
  void start_at(const Pose& pose);
  /// Sets the token for later connections.
  void set_token(std::string token);
  /// Sets the clip and the variant to ask for on the next connection. What is shown stays until
  /// there is a picture of them.
  void choose(SceneChoice choice);
  /// Asks for the ground around somebody who walks there, as far as it is not known. Call it before
  /// each frame.
  void want_ground(const glm::dvec3& eye, std::int64_t now_us);
  /// Returns the ground as far as it was asked for.
  const GroundMap& ground() const;
  /// Returns how often a server has welcomed this client.
  std::uint32_t welcomes() const;
  /// Stops the animation, or lets it go on.
  void play(bool playing, std::int64_t now_us);
  bool playing() const;
  /// True if something in the scene moves by itself, unless it is stopped.
  bool animated() const;
  /// Sets a light of this client's own. A frozen folder keeps the one it was made under.
  void set_lighting(const Lighting& lighting, std::int64_t now_us);
  /// True if the scene comes from a frozen folder: light and animation stand still.
  bool frozen() const;
  /// True if the light has ever differed from the first.
  bool light_changed() const;
  /// Asks for a full render from this camera; take_reference() returns it once it has arrived.
  void ask_reference(const Camera& camera, std::uint32_t supersample);
  std::optional<ReferenceFrame> take_reference();
  bool reference_refused() const;

  const SceneView& scene() const;
  const Lighting& lighting() const;
  const Predictor& predictor() const;  ///< of the first view
  TileCounts tiles() const;
  /// Returns counts by codec, of all tiles that were decoded.
  const CodecUses& codecs() const;
  /// Returns the codec that tiles are asked for in now.
  TileCodec codec() const;
  const UploadCounts& uploads() const;
  const std::vector<TileLife>& lives() const;
  /// Notes that the last planned frame is drawn; for the trace.
  void note_drawn(std::int64_t now_us);
  const ViewCounts& views() const;
  /// True if there is something to draw: the scene, or a view of it.
  bool drawable() const;
  /// True if the server has another scene and there is nothing of it to show yet. The last picture
  /// is then better than what frame() lists.
  bool awaits_new_scene() const;
  std::int64_t round_trip_us() const;
  /// True if something in view lacks an image of its own, and asking for it waits for the link or
  /// the server.
  bool first_waits() const;
  std::size_t in_flight() const;
  /// True if the last frame left nothing to ask for, nothing is under way and nothing moves.
  /// Further frames would do nothing until the camera, the light or the link brings something new.
  bool at_rest() const;
  std::uint64_t frame_number() const;
  const std::string& goodbye() const;

 private:
  /// Returns what is drawn in each view, after sending asks.
  std::vector<DrawList> plan_lists(const std::vector<Camera>& views, std::int64_t now_us);

  std::unique_ptr<SessionParts> parts_;
  std::unique_ptr<Arrivals> arrivals_;
};

}  // namespace mirage
