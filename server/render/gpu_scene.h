#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "shaders/gl/gpu_model.h"
#include "shaders/gl/probe_map.h"

namespace mirage {

struct Capture;
struct Material;
struct PreparedScene;

/// The whole scene on the GPU; lives on the GL thread.
struct GpuScene {
  std::shared_ptr<const PreparedScene> prepared;
  gl::GpuImages images;
  std::optional<gl::ProbeMap> probe;
  std::vector<gl::GpuMesh> meshes;                  ///< whole, by object
  std::vector<std::vector<gl::GpuMesh>> tile_lods;  ///< by object and level; level 0 is empty

  explicit GpuScene(std::shared_ptr<const PreparedScene> scene);
  /// Uploads the scene's levels of detail, those that are made. The constructor does so, too.
  void upload_levels();
  /// Returns the map for a mesh pass; nullptr: the scene has none.
  const gl::ProbeMap* probe_map() const { return probe ? &*probe : nullptr; }
  /// Returns the bytes of images, meshes at all levels, and the probe.
  std::size_t gpu_bytes() const;
  /// Returns the mesh from which a tile of this object is drawn.
  const gl::GpuMesh& mesh_for_tile(std::uint32_t object, const Capture& capture) const;
  /// Returns the mesh for a member of a group, drawn at `scale` of its own units.
  const gl::GpuMesh& mesh_for_group(std::uint32_t object, float scale,
                                    const Capture& capture) const;
  /// Returns a part of an instance (InstanceGroup::part), uploaded at its first use.
  const gl::GpuMesh& part(std::uint32_t index) const;
  const gl::GpuMesh& level(std::uint32_t object, std::size_t lod) const {
    return lod == 0 ? meshes[object] : tile_lods[object][lod];
  }
  const std::vector<Material>& materials() const;

  /// Returns the object's mesh in its pose at `clip_time_s`; static objects have only one.
  const gl::GpuMesh& posed_mesh(std::uint32_t object, double clip_time_s) const;

 private:
  /// The pose made last; it is reused, as tiles of one phase come together.
  struct Poser {
    std::uint32_t object = 0xffffffffu;
    double clip_time_s = 0;
    std::vector<Vertex> vertices;
  };
  std::unique_ptr<Poser> poser = std::make_unique<Poser>();
  std::unique_ptr<std::vector<gl::GpuMesh>> parts;
};

}  // namespace mirage
