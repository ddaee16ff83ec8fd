#include "shaders/gl/gpu_model.h"

#include <cstddef>
#include <numeric>

namespace mirage::gl {
namespace {

void upload_level(const Image& image, GLint level) {
  const GLint format = image.srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8;
  glTexImage2D(GL_TEXTURE_2D, level, format, static_cast<GLsizei>(image.width),
               static_cast<GLsizei>(image.height), 0, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
}

// Uploads an image. If `mips` is empty, the driver makes the mip levels.
Texture upload_image(const Image& image, const std::vector<Image>& mips) {
  Texture texture = Texture::create();
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  upload_level(image, 0);
  GLint level = 0;
  for (const Image& mip : mips) upload_level(mip, ++level);
  if (mips.empty()) glGenerateMipmap(GL_TEXTURE_2D);
  return texture;
}

void attribute(GLuint index, GLint size, GLenum type, GLboolean normalised, std::size_t offset) {
  glEnableVertexAttribArray(index);
  glVertexAttribPointer(index, size, type, normalised, sizeof(Vertex),
                        reinterpret_cast<const void*>(offset));
}

}  // namespace

void GpuImages::put(std::size_t index, const Image& image, const std::vector<Image>& mips) {
  if (index >= textures_.size()) {
    textures_.resize(index + 1);
    bytes_.resize(index + 1, 0);
  }
  textures_[index] = upload_image(image, mips);
  bytes_[index] = image.rgba.size() * 4 / 3;
}

std::size_t GpuImages::gpu_bytes() const {
  return std::accumulate(bytes_.begin(), bytes_.end(), std::size_t{0});
}

GLuint GpuImages::texture(std::int32_t image) const {
  const auto index = static_cast<std::size_t>(image);
  return image >= 0 && index < textures_.size() ? textures_[index].id() : 0;
}

GpuMesh::GpuMesh(const Mesh& mesh)
    : vao_(VertexArray::create()),
      vertices_(Buffer::create()),
      indices_(Buffer::create()),
      primitives_(mesh.primitives),
      vertex_color_(has_vertex_color(mesh)) {
  glBindVertexArray(vao_.id());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  const std::size_t vertex_bytes = mesh.vertices.size() * sizeof(Vertex);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertex_bytes), mesh.vertices.data(),
               GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  const std::size_t index_bytes = mesh.indices.size() * sizeof(std::uint32_t);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(index_bytes), mesh.indices.data(),
               GL_STATIC_DRAW);
  attribute(0, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, position));
  attribute(1, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, normal));
  attribute(2, 4, GL_FLOAT, GL_FALSE, offsetof(Vertex, tangent));
  attribute(3, 2, GL_FLOAT, GL_FALSE, offsetof(Vertex, uv0));
  attribute(4, 2, GL_FLOAT, GL_FALSE, offsetof(Vertex, uv1));
  if (vertex_color_) {
    attribute(5, 4, GL_UNSIGNED_SHORT, GL_TRUE, offsetof(Vertex, color));
  }
  glBindVertexArray(0);
  bytes_ = vertex_bytes + index_bytes;
}

double GpuMesh::triangles() const {
  double corners = 0;
  for (const Primitive& primitive : primitives_) corners += primitive.index_count;
  return corners / 3;
}

void GpuMesh::replace_vertices(const std::vector<Vertex>& vertices) const {
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  // A new buffer store avoids waiting for draws that still read the old one.
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)),
               vertices.data(), GL_STREAM_DRAW);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
}

}  // namespace mirage::gl
