#pragma once
// Mesh cache: which levels of geometry and images the client holds, and which it should ask for.
// Input:  what is drawn as geometry, and will be; what arrives. Output: the level each instance is
//         drawn from, needs for the scheduler, what to drop from graphics memory.
// Thread: the frame loop's.
// Full:   beyond the budget what was needed longest ago goes first, never what is drawn in this
//         frame; what does not fit is not asked for.

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

/// A texture as a mesh uses it.
struct ImageUse {
  std::uint32_t image = 0;
  double uv_per_unit = 0;  ///< texture coordinates an object unit, median over the surface
  bool masks = false;      ///< an alpha test reads it: without it the mesh is not fit to be drawn
};
std::vector<ImageUse> image_uses(const ObjectModel& model);

/// Bytes of graphics memory: of a level that is not here yet, of a mesh, of an image with its mips.
std::size_t expected_gpu_bytes(const LodInfo& lod);
std::size_t mesh_gpu_bytes(const Mesh& mesh);
std::size_t image_gpu_bytes(const glm::uvec2& size);

class MeshCache {
 public:
  void reset(const SceneView& scene, std::size_t budget_bytes, std::size_t max_reply_bytes);
  /// Learns the objects that have come since: groups, which have no geometry.
  void grow(const SceneView& scene);

  /// Per object: something of it can be drawn.
  const std::vector<bool>& ready() const { return ready_; }

  /// Gives each of `meshes` its level, and marks it as drawn in this frame.
  void choose(const SceneView& scene, const Camera& camera, double tau_px, std::uint64_t frame,
              std::int64_t now_us, std::vector<DrawnMesh>& meshes);
  /// Levels of geometry that are drawn in this frame: with their images they are in use.
  void mark_drawn(const SceneView& scene, std::uint64_t frame, std::int64_t now_us,
                  std::vector<DrawnMesh>& meshes);

  /// The level to draw the instance from: the coarsest within tau, or what comes nearest of those
  /// that are here; nullopt: none is here.
  std::optional<std::size_t> level(const SceneView& scene, const Camera& camera, double tau_px,
                                   std::uint32_t instance) const;

  /// Bytes on the wire that drawing the instance within tau still takes: its level of geometry, and
  /// images (an estimate, until it is known which they are).
  double price_bytes(const SceneView& scene, const Camera& camera, double tau_px,
                     std::uint32_t instance) const;
  /// What to ask for so that `wants` can be drawn.
  std::vector<AssetNeed> needs(const SceneView& scene, double tau_px, std::int64_t now_us,
                               const std::vector<MeshWant>& wants);

  void add_mesh(std::uint32_t object, std::uint8_t lod, const ObjectModel& model,
                std::int64_t now_us);
  void add_image(const SceneView& scene, std::uint32_t image, std::uint8_t level,
                 std::size_t reply_bytes, std::int64_t now_us);

  /// What has left the cache, to be freed: not needed for a while, or over the budget. An image
  /// that goes is replaced by its mean colour.
  std::vector<AssetId> drop(std::uint64_t frame, std::int64_t now_us);

  std::size_t bytes() const { return bytes_; }
  bool resident(const AssetId& id) const;

 private:
  struct Level {
    bool resident = false;
    std::size_t bytes = 0;  ///< of graphics memory
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
  double image_bytes_per_texel_ = 0.3;  ///< on the wire, learnt
};

/// Pixels one object unit covers at the point of `instance` nearest to the eye, at most: the bound
/// of what an error there can be seen as. Over the instance's tolerance, so that it can be held
/// against tau.
double px_per_unit(const SceneView& scene, const Camera& camera, std::uint32_t instance);

}  // namespace mirage
