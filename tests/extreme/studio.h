#pragma once
// Studio: the shipped path of one scene in one GL context: load, prepare, render tiles, encode,
// decode, cache, draw; and the full render beside it. It does what a running server and client do,
// without a socket.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/draw_list.h"
#include "client/frame/reference_frame.h"
#include "client/hold/tile_cache.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/reference_renderer.h"
#include "server/render/tile_page.h"
#include "shaders/gl/egl_context.h"
#include "tests/extreme/extreme_case.h"

namespace mirage::extreme {

using Pixels = std::vector<std::uint8_t>;

/// A tile as it left the server, and as the client decoded it.
struct MadeTile {
  wire::TileReplyT header;
  Tile tile;
  Capture capture;
};

/// Options of a studio.
struct StudioOptions {
  int msaa = 4;     ///< samples of the client's target
  int samples = 2;  ///< samples of tiles, per axis
};

class Studio {
 public:
  /// Loads `spec` as the server does. Errors: those of load_scene, kGraphics….
  static Result<std::unique_ptr<Studio>> create(const std::string& spec,
                                                const StudioOptions& options = {});
  /// Creates a studio with a scene that no file can hold. Errors as above.
  static Result<std::unique_ptr<Studio>> create(Scene scene, const StudioOptions& options = {});

  const PreparedScene& prepared() const { return *prepared_; }
  const SceneView& scene() const { return scene_; }
  const Lighting& light() const { return light_; }
  /// Sets the light of lit tiles, of drawing and of the truth from now on.
  void set_light(const Lighting& light) { light_ = light; }

  /// Returns a camera that looks at the centre of `instance` from `direction`, at a distance of
  /// `radii`. The instance's sphere fills the picture `fill` times.
  Camera camera(std::uint32_t instance, const glm::dvec3& direction, double radii, int size,
                double fill = 1.05) const;

  /// Returns the key of the tile captured exactly for this camera, at 1.5 texels per pixel as
  /// clients ask.
  TileKey key_for(const Camera& camera, std::uint32_t instance, std::uint8_t channels) const;
  MadeTile make_tile(const TileKey& key, std::uint32_t instance,
                     TileCodec codec = TileCodec::kZstd);
  /// Puts the tile into the client's cache and atlas; nullptr if it is empty.
  TileRecordPtr hold(const MadeTile& made, std::uint32_t instance);
  /// Keeps the tile from ever being evicted.
  void keep(const TileRecordPtr& tile) { cache_->mark_drawn({tile}, UINT64_MAX / 2); }

  /// Returns the picture that the client draws: RGBA8, top row first.
  Pixels draw(const Camera& camera, const DrawList& list);
  /// Draws every instance from a tile captured for this very camera.
  Pixels impostors(const Camera& camera, DrawMethod method, std::uint8_t channels = kLitTile);
  DrawList impostor_list(const Camera& camera, DrawMethod method, std::uint8_t channels = kLitTile);
  /// Draws every instance as geometry that went through the wire's codec.
  Pixels meshes(const Camera& camera);
  ReferenceFrame truth(const Camera& camera, std::uint32_t samples = 2);

  /// Returns the draw calls of the last picture, the sky's included.
  int draw_calls() const { return renderer_->draw_calls(); }
  /// Returns the scene's own meshes for drawing. The context must be current.
  const GpuScene& gpu() const { return *gpu_; }
  /// Makes this studio's context current, because several studios may exist at once.
  void make_current() { egl_.make_current(); }

 private:
  static Result<std::unique_ptr<Studio>> create(
      Result<std::shared_ptr<const PreparedScene>> prepared, const StudioOptions& options);

  gl::EglContext egl_;
  std::shared_ptr<const PreparedScene> prepared_;
  SceneView scene_;
  std::unique_ptr<GpuScene> gpu_;
  std::unique_ptr<TilePageRenderer> pages_;
  std::unique_ptr<ReferenceRenderer> references_;
  std::unique_ptr<FrameRenderer> renderer_;
  std::optional<FrameTarget> target_;
  std::unique_ptr<TileCache> cache_;
  StudioOptions options_;
  Lighting light_;
  std::uint64_t frame_ = 1;
};

/// Returns the outcome of a case whose scene cannot be shown.
Outcome no_studio(const Error& error);
/// Returns the largest difference of two pictures in one component, in steps of 1/255; 256 if their
/// sizes differ.
int largest_difference(const Pixels& a, const Pixels& b);
/// Returns the number of floats in a tile's header that are NaN or infinite.
int not_finite(const wire::TileReplyT& header);
/// Returns sRGB in steps of 1/255, of a linear value clamped to 0 to 1.
int encoded(double linear_value);
/// Returns the number of colour components above white with their pixel's alpha, which is rounded.
int above_alpha(const Pixels& rgba);
/// Returns the number of pixels with an alpha of at least `alpha`.
std::size_t covered(const Pixels& rgba, int alpha = 128);

}  // namespace mirage::extreme
