#pragma once
// Bench: server and client of one object in one GL context. Tiles go through the real renderer,
// encoder and decoder; the truth is the full render of the same build.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/draw/refinement.h"
#include "client/draw/tints.h"
#include "client/frame/draw_list.h"
#include "client/frame/reference_frame.h"
#include "client/hold/tile_cache.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "protocol/model/scene_types.h"
#include "protocol/quality/metrics.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/reference_renderer.h"
#include "server/render/tile_page.h"
#include "shaders/gl/egl_context.h"

namespace mirage::test {

/// Light of the field's protocol.
enum class BenchLight { kLit, kAlbedo, kProbe };
/// Blended materials: alpha-tested instead, as in the protocol, or kept.
enum class BenchBlending { kTested, kKept };

/// Returns direction `i` of `count` of the field's protocol: unit, elevation of at least 5 degrees.
glm::dvec3 fibonacci_direction(int i, int count);
/// Returns `direction` turned by `degrees` along the great circle that leaves it at `bearing`
/// radians.
glm::dvec3 turned(const glm::dvec3& direction, double degrees, double bearing);

/// Returns the scene as a client learns it, through the protocol; nullopt if the protocol refuses
/// it.
std::optional<SceneView> scene_as_told(const std::shared_ptr<const PreparedScene>& prepared);

class Bench {
 public:
  /// Makes the context current, because other tests of the process may have made their own since.
  void make_current() { egl_.make_current(); }
  static constexpr int kSize = 512;

  /// Creates a bench with the model at `placed`; nullptr without a GL context, or if `spec` does
  /// not load.
  static std::unique_ptr<Bench> create(const std::string& spec, BenchLight light,
                                       const Similarity& placed = {}, float fog_density = 0,
                                       BenchBlending blending = BenchBlending::kTested);

  /// Returns the field's camera: `radii` from the centre, the sphere filling the picture.
  Camera camera(double radii, const glm::dvec3& direction) const;
  /// Returns the tile for exactly this camera; nullptr: it is empty.
  TileRecordPtr tile_for(const Camera& camera, TileCache& cache, std::uint8_t channels = kLitTile);
  /// Returns the bytes of the last tile's planes on the wire.
  std::size_t tile_bytes() const { return tile_bytes_; }
  std::uint64_t tile_hash() const { return tile_hash_; }
  /// Returns an empty cache with the bench's atlas size.
  TileCache make_cache() const;
  /// Clears the target and draws.
  void draw(const Camera& camera, const TileRecordPtr& tile, DrawMethod method);
  std::vector<std::uint8_t> picture(const Camera& camera, const TileRecordPtr& tile,
                                    DrawMethod method);
  /// Returns a picture of the object and a copy of it, `behind_radii` farther from the eye, back to
  /// front.
  std::vector<std::uint8_t> picture_of_two(const Camera& camera, const TileRecordPtr& tile,
                                           double behind_radii, DrawMethod near_method,
                                           DrawMethod far_method);
  /// Returns a picture of the object's placeholder.
  std::vector<std::uint8_t> placeholder_picture(const Camera& camera);
  /// Returns a picture of the object's geometry.
  std::vector<std::uint8_t> mesh_picture(const Camera& camera, float fade = 1);
  /// Returns a picture of the geometry after this many further drawings (Refinement); the first is
  /// drawn at this scale.
  std::vector<std::uint8_t> rested_mesh_picture(const Camera& camera, int drawings,
                                                double scale = 1);
  /// Returns the tints of a list (FrameRenderer::draw_tints), RGBA8, rows from the top. Geometry is
  /// drawn if mesh_picture() has uploaded it.
  std::vector<std::uint8_t> tints(const Camera& camera, const DrawList& list, const Tints& tints);
  /// Sets the light of lit tiles, of drawing and of the truth from now on.
  void set_light(const Lighting& light) { light_ = light; }
  const Lighting& light() const { return light_; }
  /// Returns the RGBA8 pixels of the full render, `samples` per axis.
  std::vector<std::uint8_t> truth(const Camera& camera, std::uint32_t samples);
  ReferenceFrame truth_frame(const Camera& camera, std::uint32_t samples);

  const SceneView& scene() const { return scene_; }
  const InstanceView& instance() const { return scene_.instances[0]; }

 private:
  gl::EglContext egl_;
  std::shared_ptr<const PreparedScene> prepared_;
  SceneView scene_;
  std::unique_ptr<GpuScene> gpu_;
  std::unique_ptr<TilePageRenderer> pages_;
  std::unique_ptr<ReferenceRenderer> references_;
  std::unique_ptr<FrameRenderer> renderer_;
  std::unique_ptr<FrameTarget> target_;
  std::size_t tile_bytes_ = 0;
  std::uint64_t tile_hash_ = 0;
  Lighting light_;
};

}  // namespace mirage::test
