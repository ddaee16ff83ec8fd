#pragma once
// Server and client of one object in one GL context: tiles go through the real renderer, encoder
// and decoder; the truth is the full render of the same build.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/draw/refinement.h"
#include "client/frame/draw_list.h"
#include "client/hold/tile_cache.h"
#include "client/quality/metrics.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "protocol/model/scene_types.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/reference_renderer.h"
#include "server/render/tile_page.h"
#include "shaders/gl/egl_context.h"

namespace mirage::test {

/// Light of the field's protocol (FIELD.md).
enum class BenchLight { kLit, kAlbedo, kProbe };
/// Of blended materials: alpha-tested instead, as the protocol has it, or as they are.
enum class BenchBlending { kTested, kKept };

/// Direction `i` of `count` of the field's protocol: unit, elevation of at least 5 degrees.
glm::dvec3 fibonacci_direction(int i, int count);
/// `direction` turned by `degrees` along the great circle that leaves it at `bearing` radians.
glm::dvec3 turned(const glm::dvec3& direction, double degrees, double bearing);

/// The scene as a client learns it, through the protocol; nullopt when it does not get across.
std::optional<SceneView> scene_as_told(const std::shared_ptr<const PreparedScene>& prepared);

class Bench {
 public:
  /// Other tests of the process may have made contexts of their own since.
  void make_current() { egl_.make_current(); }
  static constexpr int kSize = 512;

  /// nullptr without a GL context, or when `spec` does not load. The model stands at `placed`.
  static std::unique_ptr<Bench> create(const std::string& spec, BenchLight light,
                                       const Similarity& placed = {}, float fog_density = 0,
                                       BenchBlending blending = BenchBlending::kTested);

  /// The field's camera: `radii` from the centre, the sphere filling the picture.
  Camera camera(double radii, const glm::dvec3& direction) const;
  /// The tile for exactly this camera; nullptr when it is empty.
  TileRecordPtr tile_for(const Camera& camera, TileCache& cache, std::uint8_t channels = kLitTile);
  /// Bytes of the last tile's planes as they travel.
  std::size_t tile_bytes() const { return tile_bytes_; }
  std::uint64_t tile_hash() const { return tile_hash_; }
  /// A cache of the bench's atlas size, empty.
  TileCache make_cache() const;
  /// Clears the target and draws.
  void draw(const Camera& camera, const TileRecordPtr& tile, DrawMethod method);
  std::vector<std::uint8_t> picture(const Camera& camera, const TileRecordPtr& tile,
                                    DrawMethod method);
  /// The object and a copy of it, `behind_radii` farther from the eye, back to front.
  std::vector<std::uint8_t> picture_of_two(const Camera& camera, const TileRecordPtr& tile,
                                           double behind_radii, DrawMethod near_method,
                                           DrawMethod far_method);
  /// The same with the object's geometry.
  std::vector<std::uint8_t> mesh_picture(const Camera& camera, float fade = 1);
  /// The same after so many further drawings (Refinement); the first at this scale.
  std::vector<std::uint8_t> rested_mesh_picture(const Camera& camera, int drawings,
                                                double scale = 1);
  /// From now on the light of lit tiles, of drawing and of the truth.
  void set_light(const Lighting& light) { light_ = light; }
  const Lighting& light() const { return light_; }
  /// RGBA8 of the full render, `samples` per axis.
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
