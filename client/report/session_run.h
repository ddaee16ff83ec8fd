#pragma once
// Session run: one scripted session in this process, on virtual time and a modelled link. It tells
// what a viewer would have shown at every frame of a path, what that cost, and how far it was from
// the truth.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/draw/geometric_error.h"
#include "client/frame/camera_path.h"
#include "client/frame/method_choice.h"
#include "client/link/link.h"
#include "client/link/net_model.h"
#include "client/plan/frame_plan.h"
#include "client/report/page.h"
#include "client/report/truth_source.h"
#include "client/session/tile_trace.h"
#include "protocol/quality/metrics.h"

namespace mirage {

struct DrawList;
struct PlannedFrame;
class FrameRenderer;
class SceneView;
struct Alternatives;
struct ReferenceFrame;

/// A compared frame; valid only while it is observed.
struct ObservedFrame {
  const SceneView& scene;
  const DrawList& list;
  const std::vector<Alternatives>& considered;
  const FramePlan& plan;  ///< with its choices
  const ReferenceFrame& truth;
  ImageView seen, due;
};

struct RunSpec {
  std::string url;
  std::string path = "builtin:walk";
  std::string method = "auto";
  double tau_px = 1;
  double mesh_radii = kAnyRadii;
  NetModel net;
  int width = 240, height = 135;
  int samples = 4;                  ///< of a drawn pixel; < 0: as many as pay within frame_ms, or 4
  double frame_ms = 0;              ///< budget of a frame, by `device`; 0: none
  std::optional<CostModel> device;  ///< prices of frames; frames take no virtual time
  double fps = 12;
  int frames = 36;            ///< the first is at time 0
  bool from_scene = false;    ///< time 0: the first picture, as in a viewer; else: connecting
  std::vector<int> compared;  ///< rising; only these are drawn
  int draws_each = 1;         ///< draws of a compared frame, for its time; > 1: one more at first
  std::uint32_t truth_samples = 4;
  /// Gets each compared frame; may be empty.
  std::function<void(const ObservedFrame&)> observe;
  std::vector<int> pictured;  ///< compared frames whose pictures are kept; rising
};

struct ComparedFrame {
  int frame = 0;
  ImageMeasures image;
  std::optional<double> flicker;  ///< if the frame before it was compared as well
  double client_ms = 0;           ///< time of its quickest draw
  double hole_fraction = 0;       ///< share of object pixels where nothing is drawn
};

/// The plan of a frame, for all frames, not only for the compared ones.
struct PricedFrame {
  FrameSetting setting;
  double model_ms = 0;           ///< by RunSpec::device; 0: without one, or if the picture stays
  std::uint64_t bytes_down = 0;  ///< bytes until then
};

struct RunResult {
  std::vector<ComparedFrame> frames;
  GeometricError geometric;
  /// Planning and drawing, a value per draw without the extra one: CPU time of all threads on a
  /// software renderer, otherwise wall time.
  std::vector<double> client_ms;
  std::vector<PricedFrame> planned;
  LinkTraffic traffic;
  double seconds = 0;
  std::vector<TileLife> lives;
  double first_image_ms = -1;  ///< < 0: none
  /// Instances and groups in view, and those without an image, summed over all frames.
  std::uint64_t visible = 0, placeholders = 0;
  std::uint64_t starved =
      0;  ///< frames in which a first image waited while link and server were not busy
  std::vector<Picture> pictures;  ///< of the frames `pictured`
};

class SessionRunner {
 public:
  SessionRunner();
  ~SessionRunner();
  /// Makes the GL context and all that runs share. Errors kGraphics….
  static Result<std::unique_ptr<SessionRunner>> create(const std::string& device);

  /// Runs a session. `truth` is of the server at spec.url. Errors as ClientHost's.
  Result<RunResult> run(const RunSpec& spec, TruthSource& truth);

  FrameRenderer& renderer();
  const std::string& renderer_name() const;
  bool software() const;
  /// Returns the camera of a path at a time, rounded to a microsecond like the clocks of runs.
  static Camera camera_at(const CameraPath& path, double seconds, const SceneView& scene, int width,
                          int height);

 private:
  struct Loop;
  Result<void> one_frame(Loop& loop, int frame);
  double now_ms() const;

  struct Graphics;
  std::unique_ptr<Graphics> graphics_;
};

}  // namespace mirage
