#pragma once
// Web viewer: the viewer of a browser tab. Each call draws a frame, as in the native viewer.
// Input:  messages from the link, a person's steering, the time.
// Output: the picture on the canvas, messages for the link.
// Thread: the page's.
// Full:   never; nothing waits, and something else is drawn in the place of what is missing.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/door/client.h"
#include "client/draw/insight.h"
#include "client/draw/presenter.h"
#include "client/web/browser_link.h"
#include "client/web/depth_probe.h"
#include "client/web/frame_prices.h"
#include "client/web/steered_eye.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"
#include "protocol/model/sun_place.h"

namespace mirage {

struct WebOptions {
  int width = 640, height = 360;
  double frame_ms = -1;    ///< budget of a frame; 0: none; < 0: by renderer and display
  double display_ms = 17;  ///< time between two pictures of the display
  int atlas_mb = 216, mesh_mb = 256;
  std::string token;
  SceneChoice choice;  ///< to ask for at first
};

class WebViewer {
 public:
  static constexpr double kFovY = 1.0471975511965976;  ///< radians, until another is set

  /// Creates the viewer. Needs a current WebGL 2 context. Errors kGraphicsShader, kGraphicsGl.
  static Result<std::unique_ptr<WebViewer>> create(const WebOptions& options,
                                                   std::function<void(const Bytes&)> write);
  ~WebViewer();

  BrowserLink& link() { return link_; }
  ClientSession& session() { return client_.session(); }
  const ClientSession& session() const { return client_.session(); }

  struct Frame {
    bool drawn = false;     ///< a new picture was drawn
    bool resting = false;   ///< nothing changes until somebody steers or something arrives
    bool drawable = false;  ///< some of the scene can be seen
  };
  /// Takes in what has arrived, plans, asks and draws, at `now_us` of the session. The canvas has
  /// this size.
  Result<Frame> frame(std::int64_t now_us, int width, int height);

  /// Moves the eye by what a person did.
  void steer(const Steering& by);
  SteerMode steer_mode() const { return eye_.pilot().mode(); }
  /// True if who walks flies; False: the feet stay on the ground.
  bool flies() const { return eye_.pilot().flies(); }
  void set_flies(bool flies) { eye_.pilot().set_flies(flies); }
  /// True if the scene is walked on its ground.
  bool has_ground() const;
  void set_steer_mode(SteerMode mode) { eye_.pilot().set_mode(mode); }
  /// Makes what is seen at a place of the picture (0 to 1, right and down) the pivot. False:
  /// nothing is there, and the pivot stays.
  bool aim(const glm::dvec2& place);
  /// Returns the name of the object seen at a place, as its file has it; empty: it has none, or
  /// nothing is there.
  std::string name_at(const glm::dvec2& place) const;
  /// Returns the server's number of that object; nullopt: nothing is there, or several as one.
  std::optional<std::uint32_t> object_at(const glm::dvec2& place) const;
  void set_pose(const Pose& pose);
  const Pose& pose() const { return eye_.pose(); }
  /// Moves the eye to the scene's home view.
  void go_home();
  /// Sets the vertical field of view, radians: 0 < fov_y < pi.
  void set_fov(double fov_y) { fov_y_ = fov_y; }
  /// Sets how much of the usual time a moving picture may take: less is smoother, more is sharper.
  void set_pace(double share);
  /// Sets the clip and the variant to ask for on the next connection.
  void choose(SceneChoice choice);
  void play(bool playing, std::int64_t now_us);
  bool home_known() const;
  /// Sets the sun's place in the sky; its strength stays the scene's. nullopt: the scene's own
  /// light.
  void set_sun(const std::optional<SunPlace>& at, std::int64_t now_us);
  /// Returns where the scene's own sun stands; nullopt: it has no directional light.
  std::optional<SunPlace> own_sun() const;

  FramePrices& frame_prices() { return prices_; }
  /// Return the time, ms, of the last frame for taking in messages, and for uploading to the
  /// graphics card.
  double decode_ms() const { return decode_ms_; }
  double upload_ms() const { return upload_ms_; }
  const CostModel& prices() const;
  void set_prices(const CostModel& prices) { client_.set_prices(prices); }
  /// Scales all prices by how long a background takes.
  void probe() { prices_.probe(camera()); }

  /// Shows this colour, linear, behind everything; nullopt: the scene's own sky or studio.
  void set_background(const std::optional<glm::vec3>& color);
  /// Shows over the picture how it was made.
  void show_layer(InsightLayer layer);

  void ask_reference(std::uint32_t supersample);
  /// Returns the shown picture: RGBA, rows from the top.
  std::vector<std::uint8_t> pixels() const;
  /// Returns the eye depth of each pixel of that picture, metres; 0: nothing is there. Errors
  /// kGraphicsShader; kGraphicsGl: no memory.
  Result<std::vector<float>> depths();
  std::string renderer() const;  ///< name of what draws
  int width() const;
  int height() const;

  /// Returns the figures for the page's strip, as JSON.
  std::string figures(std::int64_t now_us) const;

 private:
  WebViewer(const WebOptions& options, std::function<void(const Bytes&)> write);
  Camera camera() const;

  void fit_canvas(int width, int height);

  const WebOptions options_;
  BrowserLink link_;
  Client client_;
  Presenter presenter_;
  Insight insight_;
  std::optional<DepthProbe> probe_;  // made when it is first needed
  InsightLayer layer_ = InsightLayer::kNone;
  SteeredEye eye_;
  double fov_y_ = kFovY;
  int canvas_width_ = 0, canvas_height_ = 0;
  FramePrices prices_;
  double decode_ms_ = 0, upload_ms_ = 0;
  std::string problem_;  // last problem of drawing
};

}  // namespace mirage
