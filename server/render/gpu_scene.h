#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "protocol/capture.h"
#include "server/prepare/prepared_scene.h"
#include "shaders/gl/gpu_model.h"
#include "shaders/gl/probe_map.h"

namespace mirage {

/// The whole scene on the GPU; lives on the GL thread.
struct GpuScene {
  std::shared_ptr<const PreparedScene> prepared;
  gl::GpuImages images;
  std::optional<gl::ProbeMap> probe;
  std::vector<gl::GpuMesh> meshes;                  ///< whole, by object
  std::vector<std::vector<gl::GpuMesh>> tile_lods;  ///< by object and level; the whole is empty

  explicit GpuScene(std::shared_ptr<const PreparedScene> scene) : prepared(std::move(scene)) {
    for (std::size_t i = 0; i < prepared->scene.images.size(); ++i) {
      images.put(i, prepared->scene.images[i], prepared->mips[i]);
    }
    if (prepared->scene.probe) probe = gl::ProbeMap::create(*prepared->scene.probe);
    for (const SceneObject& object : prepared->scene.objects) meshes.emplace_back(object.mesh);
    for (const ObjectGeometry& geometry : prepared->geometry) {
      std::vector<gl::GpuMesh>& lods = tile_lods.emplace_back();
      for (const Mesh& mesh : geometry.tile_lods) {
        lods.push_back(mesh.primitives.empty() ? gl::GpuMesh() : gl::GpuMesh(mesh));
      }
    }
  }
  /// For a mesh pass; nullptr: the scene has none.
  const gl::ProbeMap* probe_map() const { return probe ? &*probe : nullptr; }
  /// Of images and meshes, all levels, and the probe.
  std::size_t gpu_bytes() const {
    std::size_t bytes = images.gpu_bytes() + (probe ? probe->gpu_bytes() : 0);
    for (const gl::GpuMesh& mesh : meshes) bytes += mesh.gpu_bytes();
    for (const std::vector<gl::GpuMesh>& lods : tile_lods) {
      for (const gl::GpuMesh& mesh : lods) bytes += mesh.gpu_bytes();
    }
    for (const gl::GpuMesh& mesh : *parts) bytes += mesh.gpu_bytes();
    return bytes;
  }
  /// What a tile of this object is drawn from.
  const gl::GpuMesh& mesh_for_tile(std::uint32_t object, const Capture& capture) const {
    return level(object, lod_for_tile(prepared->objects[object].lods, capture));
  }
  /// The same for a member of a group, drawn at `scale` of its own units.
  const gl::GpuMesh& mesh_for_group(std::uint32_t object, float scale,
                                    const Capture& capture) const {
    const double allowed = allowed_tile_error(capture) / double{scale};
    return level(object, lod_within(prepared->objects[object].lods, allowed));
  }
  /// A part of an instance (InstanceGroup::part); it is put on the GPU when it is first asked for.
  const gl::GpuMesh& part(std::uint32_t index) const {
    gl::GpuMesh& mesh = (*parts)[index];
    if (mesh.primitives().empty()) mesh = gl::GpuMesh(prepared->parts[index]);
    return mesh;
  }
  const gl::GpuMesh& level(std::uint32_t object, std::size_t lod) const {
    return lod == 0 ? meshes[object] : tile_lods[object][lod];
  }
  const std::vector<Material>& materials() const { return prepared->scene.materials; }

  /// The object's mesh in its pose at `clip_time_s`; static objects have but one.
  const gl::GpuMesh& posed_mesh(std::uint32_t object, double clip_time_s) const {
    const SceneObject& source = prepared->scene.objects[object];
    if (!source.animation) return meshes[object];
    if (poser->object != object || poser->clip_time_s != clip_time_s) {
      *poser = {object, clip_time_s, std::move(poser->vertices)};
      pose_vertices(source.mesh.vertices, *source.animation, clip_time_s, poser->vertices);
      meshes[object].replace_vertices(poser->vertices);
    }
    return meshes[object];
  }

 private:
  /// Which pose was made last: tiles of one phase come together.
  struct Poser {
    std::uint32_t object = 0xffffffffu;
    double clip_time_s = 0;
    std::vector<Vertex> vertices;
  };
  std::unique_ptr<Poser> poser = std::make_unique<Poser>();
  std::unique_ptr<std::vector<gl::GpuMesh>> parts =
      std::make_unique<std::vector<gl::GpuMesh>>(prepared->parts.size());
};

}  // namespace mirage
