#pragma once
// An object's mesh, materials and images on the GPU, for tiles, references and client meshes.

#include <memory>
#include <vector>

#include "protocol/model/model.h"
#include "protocol/model/need_mask.h"
#include "shaders/gl/gl_object.h"

namespace mirage::gl {

/// Images of a scene as textures, shared by the objects that use them; 1x1 white if decoding
/// failed. They are mip-mapped, colour images as sRGB. Images of alpha-tested materials keep their
/// coverage.
class GpuImages {
 public:
  /// Replaces one image (any index: the list grows) with mip levels from alpha_preserving_mips();
  /// none: the driver makes them.
  void put(std::size_t index, const Image& image, const std::vector<Image>& mips);
  GLuint texture(std::int32_t image) const;
  std::size_t gpu_bytes() const;

 private:
  std::vector<Texture> textures_;
  std::vector<std::size_t> bytes_;
};

/// Vertex and index buffers of one mesh.
class GpuMesh {
 public:
  GpuMesh() = default;
  /// Uploads a mesh. What is the same at all of its vertices takes the room of one, unless it is
  /// `posed`: then each vertex has all attributes, since poses change them.
  explicit GpuMesh(const Mesh& mesh, bool posed = false);

  /// Replaces the vertices of a posed mesh by as many others. The mesh's identity does not change.
  void replace_vertices(const std::vector<Vertex>& vertices) const;

  GLuint vertex_array() const { return vao_.id(); }
  const std::vector<Primitive>& primitives() const { return primitives_; }
  /// Returns the number of triangles, computed from all corners.
  double triangles() const;
  bool vertex_color() const { return vertex_color_; }
  std::size_t gpu_bytes() const { return bytes_; }

 private:
  void upload_vertices(const std::vector<Vertex>& vertices, bool posed);

  VertexArray vao_;
  Buffer vertices_;
  Buffer indices_;
  std::vector<Primitive> primitives_;
  bool vertex_color_ = false;
  std::size_t bytes_ = 0;
};

}  // namespace mirage::gl
