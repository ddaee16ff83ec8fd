#pragma once
// The shipped path of one scene in one GL context: load, prepare, render tiles, encode, decode,
// cache, draw; and the full render beside it. What a running server and client do, without a
// socket.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/draw_list.h"
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

/// A tile as it left the server and as the client decoded it.
struct MadeTile {
  wire::TileReplyT header;
  Tile tile;
  Capture capture;
};

/// What a studio is set up with.
struct StudioOptions {
  int msaa = 4;     ///< of the client's target
  int samples = 2;  ///< per axis, of tiles
};

class Studio {
 public:
  /// Loads `spec` as the server does. Errors: those of load_scene, kGraphics….
  static Result<std::unique_ptr<Studio>> create(const std::string& spec,
                                                const StudioOptions& options = {});
  /// The same of a scene that no file could hold.
  static Result<std::unique_ptr<Studio>> create(Scene scene, const StudioOptions& options = {});

  const PreparedScene& prepared() const { return *prepared_; }
  const SceneView& scene() const { return scene_; }
  const Lighting& light() const { return light_; }
  /// From now on the light of lit tiles, of drawing and of the truth.
  void set_light(const Lighting& light) { light_ = light; }

  /// Looks at the centre of `instance` from `direction`, `radii` off, its sphere filling the
  /// picture `fill` times.
  Camera camera(std::uint32_t instance, const glm::dvec3& direction, double radii, int size,
                double fill = 1.05) const;

  /// Key of the tile captured exactly for this camera, 1.5 texels per pixel as clients ask.
  TileKey key_for(const Camera& camera, std::uint32_t instance, std::uint8_t channels) const;
  MadeTile make_tile(const TileKey& key, std::uint32_t instance,
                     TileCodec codec = TileCodec::kZstd);
  /// Into the client's cache and atlas; nullptr when there is nothing in it.
  TileRecordPtr hold(const MadeTile& made, std::uint32_t instance);
  /// It is never evicted.
  void keep(const TileRecordPtr& tile) { cache_->mark_drawn({tile}, UINT64_MAX / 2); }

  /// RGBA8, top row first, as the client draws it.
  Pixels draw(const Camera& camera, const DrawList& list);
  /// Every instance from a tile captured for this very camera.
  Pixels impostors(const Camera& camera, DrawMethod method, std::uint8_t channels = kLitTile);
  DrawList impostor_list(const Camera& camera, DrawMethod method, std::uint8_t channels = kLitTile);
  /// Every instance as geometry that went through the wire's codec.
  Pixels meshes(const Camera& camera);
  ReferenceFrame truth(const Camera& camera, std::uint32_t samples = 2);

  /// Draw calls of the last picture, the sky's included.
  int draw_calls() const { return renderer_->draw_calls(); }
  /// To draw with the scene's own meshes; the context is current.
  const GpuScene& gpu() const { return *gpu_; }
  /// Several studios may live at once: the one to draw with.
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

/// Of a case whose scene cannot be shown.
Outcome no_studio(const Error& error);
/// Largest difference of two pictures in one component, in steps of 1/255; 256 when they are not
/// of one size.
int largest_difference(const Pixels& a, const Pixels& b);
/// Number of floats of a tile's header that are NaN or infinite.
int not_finite(const wire::TileReplyT& header);
/// sRGB in steps of 1/255, of a linear value that is clamped to 0 to 1.
int encoded(double linear_value);
/// Colour components that are more than white of their pixel's alpha, which is rounded, would be.
int above_alpha(const Pixels& rgba);
/// Pixels with an alpha of at least `alpha`.
std::size_t covered(const Pixels& rgba, int alpha = 128);

}  // namespace mirage::extreme
