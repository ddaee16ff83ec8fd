#pragma once
// Mesh cache: which levels of geometry and images the client holds, and which it should ask for.
// Input:  what is drawn as geometry, now and soon; geometry and images that arrive.
// Output: the level each instance is drawn from, needs for the scheduler, what to drop from
//         graphics memory.
// Thread: the frame loop's.
// Full:   it drops what was needed longest ago, never what is drawn in this frame. The client does
//         not ask for what would not fit.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "client/frame/drawn_mesh.h"
#include "client/hold/asset_need.h"

namespace mirage {

struct Camera;
struct LodInfo;
struct Mesh;
struct ObjectModel;
class SceneView;

/// A texture of a mesh, with its use.
struct ImageUse {
  std::uint32_t image = 0;
  double uv_per_unit = 0;  ///< texture coordinates an object unit, median over the surface
  bool masks = false;      ///< an alpha test reads it; the mesh cannot be drawn without it
};
std::vector<ImageUse> image_uses(const ObjectModel& model);

/// Return bytes of graphics memory: of a level not here yet, of a mesh, of an image with its mips.
std::size_t expected_gpu_bytes(const LodInfo& lod);
std::size_t mesh_gpu_bytes(const Mesh& mesh);
std::size_t image_gpu_bytes(const glm::uvec2& size);

class MeshCache {
 public:
  void reset(const SceneView& scene, std::size_t budget_bytes, std::size_t max_reply_bytes);
  /// Learns the objects that have arrived since. They are groups, which have no geometry.
  void grow(const SceneView& scene);

  /// Returns for each object whether it can be drawn as geometry: a level and its masks are here.
  const std::vector<bool>& ready() const { return ready_; }

  /// Sets the level of each of `meshes`, and marks it as drawn in this frame.
  void choose(const SceneView& scene, const Camera& camera, double tau_px, std::uint64_t frame,
              std::int64_t now_us, std::vector<DrawnMesh>& meshes);
  /// Marks the levels of `meshes`, and their images, as drawn in this frame.
  void mark_drawn(const SceneView& scene, std::uint64_t frame, std::int64_t now_us,
                  std::vector<DrawnMesh>& meshes);

  /// Returns the level to draw the instance from: the coarsest within tau, or else the resident one
  /// that comes nearest to it; nullopt: none is resident.
  std::optional<std::size_t> level(const SceneView& scene, const Camera& camera, double tau_px,
                                   std::uint32_t instance) const;

  /// Returns the bytes on the wire that are still missing to draw the instance within tau: its
  /// level of geometry, and images. The images are an estimate until their names are known.
  double price_bytes(const SceneView& scene, const Camera& camera, double tau_px,
                     std::uint32_t instance) const;
  /// Returns what to ask for so that `wants` can be drawn.
  std::vector<AssetNeed> needs(const SceneView& scene, double tau_px, std::int64_t now_us,
                               const std::vector<MeshWant>& wants);

  void add_mesh(std::uint32_t object, std::uint8_t lod, const ObjectModel& model,
                std::int64_t now_us);
  void add_image(const SceneView& scene, std::uint32_t image, std::uint8_t level,
                 std::size_t reply_bytes, std::int64_t now_us);

  /// Drops what was not needed for a while, and what is over the budget. Returns it, to be freed. A
  /// dropped image is replaced by its mean colour.
  std::vector<AssetId> drop(std::uint64_t frame, std::int64_t now_us);

  std::size_t bytes() const { return bytes_; }
  bool resident(const AssetId& id) const;

 private:
  struct Level {
    bool resident = false;
    std::size_t bytes = 0;  ///< bytes of graphics memory
    std::int64_t needed_us = 0;
    std::uint64_t drawn_frame = 0;
  };
  struct Object {
    std::vector<Level> lods;
    std::vector<ImageUse> uses;
    bool known_uses = false;
  };
  struct ImageState {
    Level held;
    int level = -1;  ///< -1: only the mean colour
  };
  void need_mesh(const SceneView& scene, const MeshWant& want, double tau_px, std::int64_t now_us,
                 std::vector<AssetNeed>& out);
  void need_images(const SceneView& scene, const MeshWant& want, std::int64_t now_us,
                   std::vector<AssetNeed>& out);
  void update_ready(std::uint32_t object);
  bool fits(std::size_t more_bytes, std::int64_t now_us) const;
  void forget(Level& level, const AssetId& id, std::vector<AssetId>& out);

  std::vector<Object> objects_;
  std::vector<ImageState> images_;
  std::vector<bool> ready_;
  std::size_t budget_ = 0;
  std::size_t max_reply_bytes_ = 0;
  std::size_t bytes_ = 0;
  double image_bytes_per_texel_ = 0.3;  ///< bytes on the wire, learnt from replies
};

/// Returns the pixels that one object unit covers, at most: at the point of `instance` nearest to
/// the eye. An error there cannot look larger. The value is divided by the instance's tolerance, so
/// that it can be compared with tau.
double px_per_unit(const SceneView& scene, const Camera& camera, std::uint32_t instance);

}  // namespace mirage
