#pragma once
// Frame renderer: sky, geometry, impostors, with the true camera.
// Thread: the GL one (the frame loop's).

#include <map>
#include <memory>
#include <optional>

#include "client/draw/caster_pass.h"
#include "client/draw/frame_target.h"
#include "client/draw/impostor_pass.h"
#include "client/draw/shadow_atlas.h"
#include "client/draw/view_pass.h"
#include "client/frame/asset_id.h"
#include "protocol/model_codec.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/sky_pass.h"

namespace mirage {

/// Bytes of graphics memory by what they are for.
struct GpuBytes {
  std::size_t atlas = 0;     ///< of tiles, all planes
  std::size_t geometry = 0;  ///< meshes and their images
  std::size_t shadows = 0;   ///< atlas of shadow and caster tiles, the map
  std::size_t view = 0;      ///< the view tile
  std::size_t all() const { return atlas + geometry + shadows + view; }
};

class FrameRenderer {
 public:
  /// `flat`: as of ImpostorPass::create.
  static Result<FrameRenderer> create(int atlas_edge, int atlas_layers,
                                      const std::set<DrawMethod>& flat = kAutoFlatMethods);

  /// Learns a new scene. Error kGraphicsShader: it is drawn, without its fog.
  Result<void> reset(const SceneView& scene);
  /// These three: error kGraphicsGl, no graphics memory is left.
  Result<void> upload(const TileRecord& record, const TilePixels& pixels) {
    return impostors_.upload(record, pixels);
  }
  Result<void> upload_shadow(const ShadowRecord& record, const std::vector<std::uint8_t>& shares) {
    return shadow_atlas_.upload_shadow(record, shares);
  }
  Result<void> upload_caster(const ShadowRecord& record, const std::vector<std::uint8_t>& codes) {
    return shadow_atlas_.upload_caster(record, codes);
  }
  void upload_view(const ViewTile& view) { view_.upload(view); }
  /// Error kGraphicsShader: it cannot be drawn as it should.
  Result<void> add_mesh(std::uint32_t object, std::uint8_t lod, ObjectModel model);
  void add_image(const SceneView& scene, std::uint32_t index, const Image& image);
  void drop(const SceneView& scene, const AssetId& id);

  void draw(const FrameTarget& target, const Camera& shown, const SceneView& scene,
            const DrawList& list, const Lighting& lighting);

  /// Reads textures so many levels sharper from now on, and those of alpha tests.
  void sharpen(float levels, float tested_levels) { mesh_pass_->sharpen(levels, tested_levels); }
  void sharpen_as_usual();

  /// Draw calls of the last frame.
  int draw_calls() const { return draw_calls_; }
  GpuBytes gpu_bytes() const;

 private:
  struct ClientMesh {
    gl::GpuMesh mesh;
    std::vector<Material> materials;
    std::vector<Vertex> bind;  ///< of a moving object
    std::shared_ptr<const Animation> animation;
    double posed_at_s = -1;  ///< clip time of the vertices uploaded last
  };
  void show_mean(const SceneView& scene, std::uint32_t image);
  void pose(ClientMesh& mesh, const InstanceView& instance, double time_s);
  void draw_shadow_map(const SceneView& scene, const CasterListPtr& casters);
  void draw_meshes(const Camera& camera, const SceneView& scene, const DrawList& list,
                   const Lighting& lighting, bool blended, DepthMapping mapping);

  ImpostorPass impostors_;
  ViewPass view_;
  gl::SkyPass sky_;
  std::optional<gl::ProbeMap> probe_;
  std::unique_ptr<gl::MeshPass> mesh_pass_ = std::make_unique<gl::MeshPass>(gl::MeshOutput::kColor);
  std::map<std::pair<std::uint32_t, std::uint8_t>, ClientMesh> meshes_;  ///< by object and level
  gl::GpuImages images_;                                                 ///< of the scene
  std::vector<Vertex> posed_;                                            ///< scratch
  ShadowAtlas shadow_atlas_;
  CasterPass casters_;
  std::unique_ptr<gl::MeshPass> caster_meshes_ =
      std::make_unique<gl::MeshPass>(gl::MeshOutput::kDepth);
  gl::ShadowMap shadow_map_;  ///< made when first needed
  CasterListPtr in_map_;      ///< what the map shows
  int draw_calls_ = 0;
};

}  // namespace mirage
