#pragma once
// The viewer of a browser tab: one frame a call, as the native one draws them.
// Input:  what the link brings, where a person steers, the time. Output: the picture on the canvas,
// messages for the link. Thread: the page's. Nothing waits: what is not there is stood in for.

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/draw/frame_renderer.h"
#include "client/draw/insight.h"
#include "client/draw/presenter.h"
#include "client/frame/draw_list.h"
#include "client/price/cost_fit.h"
#include "client/screen/screen.h"
#include "client/session/client_session.h"
#include "client/web/browser_link.h"
#include "protocol/impostor/camera.h"

namespace mirage {

struct Steering;

struct WebOptions {
  int width = 640, height = 360;
  double frame_ms = -1;    ///< budget of a frame; 0: none; < 0: by renderer and display
  double display_ms = 17;  ///< between two pictures of the display
  int atlas_mb = 216, mesh_mb = 256;
  std::string token;
};

class WebViewer {
 public:
  /// A WebGL 2 context is current. Errors kGraphicsShader, kGraphicsGl.
  static Result<std::unique_ptr<WebViewer>> create(const WebOptions& options,
                                                   std::function<void(const Bytes&)> write);
  ~WebViewer();

  BrowserLink& link() { return link_; }
  const ClientSession& session() const { return *session_; }

  struct Frame {
    bool drawn = false;     ///< another picture is on the canvas
    bool resting = false;   ///< nothing changes until somebody steers or something comes
    bool drawable = false;  ///< there is something of the scene to be seen
  };
  /// Takes in what came, plans, asks, draws, at `now_us` of the session. The canvas has this size.
  Result<Frame> frame(std::int64_t now_us, int width, int height);

  /// By what a person did: moves in seconds at twice the scene's walking speed.
  void steer(const Steering& by);
  void set_pose(const Pose& pose) {
    pose_ = pose;
    posed_ = true;
  }
  const Pose& pose() const { return pose_; }
  /// Where the scene wants to be seen from.
  void go_home();
  bool home_known() const { return session_->scene().welcomed(); }
  /// The sun's direction by where it stands, degrees: azimuth from -z (the eye's usual direction)
  /// to the right, elevation. The strengths stay the scene's. nullopt: the scene's own light.
  void set_sun(std::optional<std::array<double, 2>> azimuth_elevation, std::int64_t now_us);

  /// The graphics card took `ms` for this one of the last drawn frames.
  void note_gpu_ms(std::uint64_t drawn_frame, double ms);
  /// The display shows a picture `ms` after the one before; both were drawn.
  void note_interval_ms(double ms);
  /// What came in the last frame took so long to be taken in, and so long to go to the graphics
  /// card.
  double decode_ms() const { return decode_ms_; }
  double upload_ms() const { return upload_ms_; }
  std::uint64_t drawn_frames() const { return drawn_frames_; }
  const CostModel& prices() const { return prices_.model(); }
  void set_prices(const CostModel& prices);
  /// Draws nothing but a background a few times, waits for it, and scales all prices by what it
  /// took.
  void probe();

  /// Beside the picture itself, how it came about.
  void show_layer(InsightLayer layer);

  void ask_reference(std::uint32_t supersample);
  std::optional<ReferenceFrame> take_reference() { return session_->take_reference(); }
  /// RGBA as shown, rows from the top.
  std::vector<std::uint8_t> pixels() const { return screen_.shown().read(); }
  int width() const { return screen_.width(); }
  int height() const { return screen_.height(); }

  /// For the page's strip of figures, as JSON.
  std::string figures(std::int64_t now_us) const;

 private:
  WebViewer(const WebOptions& options, std::function<void(const Bytes&)> write);
  Camera camera() const;

  struct Drawn {
    std::uint64_t frame = 0;
    FrameWork work;
  };
  /// Drawn one after the other.
  struct Paced {
    int frames = 0;
    FrameWork work;
    double ms = 0;
  };
  void fit_canvas(int width, int height);
  void note_work(const FrameWork& work);
  bool prices_rest() const;

  const WebOptions options_;
  BrowserLink link_;
  std::optional<FrameRenderer> renderer_;
  Presenter presenter_;
  Screen screen_;
  Insight insight_;
  InsightLayer layer_ = InsightLayer::kNone;
  std::unique_ptr<ClientSession> session_;
  CostFit prices_;
  Pose pose_;
  bool posed_ = false;
  int canvas_width_ = 0, canvas_height_ = 0;
  DrawList list_;  // of the last frame
  std::deque<Drawn> drawn_;
  Paced paced_;
  bool timed_ = false;  ///< the graphics card's clock can be read here
  std::uint64_t drawn_frames_ = 0;
  Pose priced_pose_;      // that the last drawn frames were seen from
  int seen_from_it_ = 0;  // frames
  std::uint64_t programs_ = 0;
  double decode_ms_ = 0, upload_ms_ = 0;
  bool compiled_ = false;  // something was, in the last frame
  std::string problem_;    // of drawing, the last
};

}  // namespace mirage
