#pragma once
// Layer: Mirage inside the picture of somebody else, in a browser. It draws each view into textures
// of its own on the host's WebGL 2 context; the host lays them into its picture by depth.
// Input:  messages from the link, the host's cameras, the time.
// Output: a texture of colour and one of depth for each view; messages for the link.
// Thread: the page's.
// Full:   never; nothing waits, and something else is drawn in the place of what is missing.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "client/door/client.h"
#include "client/draw/presenter.h"
#include "client/web/browser_link.h"
#include "client/web/depth_probe.h"
#include "protocol/model/scene_types.h"

namespace mirage {

struct LayerOptions {
  double frame_ms = 0;  ///< budget of a frame; 0: by renderer
  double tau_px = 1;
  int samples = 0;  ///< of a pixel; 0: chosen by the frame plan
  int atlas_mb = 216, mesh_mb = 256;
  bool sky = false;  ///< draws the scene's own background behind everything
  std::string token;
  SceneChoice choice;  ///< to ask for at first
};

/// The picture of a view. Names are GL's; they and the texels stay until the next frame.
struct LayerPicture {
  GLuint color = 0;            ///< sRGB, 8 bits, premultiplied; alpha: share that objects cover
  GLuint depth = 0;            ///< window depth, 32-bit float
  int width = 0, height = 0;   ///< texels of both
  glm::dvec2 window_depth{0};  ///< depth = x + y / eye depth in metres of the scene
};

class Layer {
 public:
  Layer(LayerOptions options, std::function<void(const Bytes&)> write);
  ~Layer();

  BrowserLink& link() { return link_; }
  const ClientSession& session() const { return client_.session(); }
  ClientSession& session() { return client_.session(); }

  /// Makes programs and targets in the current WebGL 2 context, and begins a session: the link has
  /// to connect anew. Errors kGraphicsShader, kGraphicsGl.
  Result<void> attach();
  /// Gives up programs and targets; after a lost context their names are only forgotten.
  void detach(bool context_lost);
  bool attached() const { return attached_; }

  struct Frame {
    bool drawn = false;     ///< some view has a new picture
    bool resting = false;   ///< nothing changes until a camera moves or something arrives
    bool drawable = false;  ///< some of the scene can be seen
  };
  /// Takes in what has arrived, plans, asks and draws, at `now_us` of the session. The cameras see
  /// the whole scene. GL values are set to their initial ones before and after. Error kGraphicsGl.
  Result<Frame> frame(std::int64_t now_us, const std::vector<Camera>& views);
  /// Returns the pictures of the last frame; empty: there were none.
  const std::vector<LayerPicture>& pictures() const { return pictures_; }
  /// Shows the first view on the canvas of the context, which has the size of that picture.
  void present();

  /// Returns the point that a picture shows at a place (0 to 1, right and down), m; nullopt:
  /// nothing. It waits for the graphics card, and sets GL values as frame() does.
  std::optional<glm::dvec3> point_at(std::size_t view, const glm::dvec2& place);
  /// Notes how long the graphics card took for the last new pictures, ms.
  void note_gpu_ms(double ms) { client_.done(ms, 0); }
  /// Returns the figures of the picture, as JSON.
  std::string figures(std::int64_t now_us) const;
  /// Returns the last problem of drawing; empty: none.
  const std::string& problem() const { return problem_; }

 private:
  Result<void> take_pictures();

  const LayerOptions options_;
  BrowserLink link_;
  Client client_;
  Presenter presenter_;
  DepthProbe probe_;
  bool attached_ = false;
  std::vector<LayerPicture> pictures_;
  std::uint64_t drawn_frames_ = 0;
  std::string problem_;
};

}  // namespace mirage
