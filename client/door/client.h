#pragma once
// Client: a whole client of one server but for its link, its window and its camera. This is the one
// frame loop; viewers, page, report and benchmarks call it in this order:
//
//   attach() with a GL context current, open() with a link
//   each frame: update(), resize(), plan(), draw(), done()
//
// Input:  a link, cameras, the time.
// Output: the picture of each frame; asks on the link.
// Thread: one at a time, with the context of attach() current.
// Full:   as ClientSession.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <vector>

#include "client/frame/frame_step.h"
#include "client/frame/method_choice.h"
#include "protocol/base/result.h"

namespace mirage {

class ClientSession;
class CostFit;
class FrameRenderer;
class Link;
class Screen;
struct Camera;
struct ClientOptions;
struct CostModel;
struct FrameWork;
struct PlannedFrame;
struct Pose;

/// Graphics memory and programs of a client.
struct ClientGraphics {
  int width = 640, height = 360;  ///< of the first picture, px
  int atlas_edge = 1024, atlas_layers = 24;
  std::set<DrawMethod> flat = kAutoFlatMethods;  ///< as in FrameRenderer::create()
};

class Client {
 public:
  Client();
  ~Client();

  /// Makes programs and targets. Errors kGraphicsShader, kGraphicsGl. Without it the client holds
  /// and draws nothing: it only learns the scene and takes full renders.
  Result<void> attach(const ClientGraphics& graphics);
  /// Gives up programs and targets, after close(). If the context is lost, their names are
  /// forgotten and nothing is deleted. attach() can follow.
  void detach(bool context_lost);
  /// Begins a session on a link, which must outlive it; the one before ends. `problem` is told what
  /// is not drawn as it should be; it may be empty. The size of the atlas is that of attach().
  void open(Link& link, ClientOptions options, std::function<void(const Error&)> problem);

  /// Ends the session, before its link goes.
  void close();

  /// The session; only between open() and close().
  ClientSession& session();
  const ClientSession& session() const;
  /// The renderer and the picture; only after attach().
  FrameRenderer& renderer();
  const FrameRenderer& renderer() const;
  Screen& screen(std::size_t view = 0);
  const Screen& screen(std::size_t view = 0) const;

  /// Takes in what has arrived, and uploads it. An error is for the log.
  Result<void> update(std::int64_t now_us);
  /// Returns the time of all uploads so far, ms.
  double upload_ms() const;
  /// Gives the picture of the first view a size, px. Error kGraphicsGl.
  Result<void> resize(int width, int height);
  /// Returns the camera of a pose: it has the size of the picture, and sees the whole scene.
  Camera camera(const Pose& pose, double fov_y) const;
  /// Plans a frame of one or several views, each with a picture of its camera's size, and sends
  /// asks. Returns what draw() will do: drawing in some view counts before refining, and that
  /// before keeping. Error kGraphicsGl.
  Result<FrameStep> plan(const std::vector<Camera>& views, std::int64_t now_us);
  Result<FrameStep> plan(const Camera& camera, std::int64_t now_us);
  /// Returns the frame that was planned last, as it is in one of its views.
  const PlannedFrame& planned(std::size_t view = 0) const;
  /// Draws or refines a planned view, or keeps its picture; again, it keeps it.
  void draw(std::size_t view = 0);
  /// Returns the graphics memory of renderer and pictures, bytes.
  std::size_t gpu_bytes() const;
  /// Returns the work of the last new pictures, and the programs that were compiled for them.
  const FrameWork& drawn_work() const;
  std::uint64_t compiled() const;

  /// Sets the prices of this device, and from then on learns them.
  void set_prices(const CostModel& prices);
  /// Returns the prices as they were learnt; nullptr: none are.
  const CostFit* prices() const;
  /// Learns that this work took `ms`.
  void learn(const FrameWork& work, double ms);
  /// Learns that the last new picture took `ms`, and everything else in its frame `beside_ms`.
  void done(double ms, double beside_ms);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace mirage
