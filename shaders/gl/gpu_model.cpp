#include "shaders/gl/gpu_model.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
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

struct Attribute {
  GLint size;
  GLenum type;
  std::size_t offset;  // in Vertex
  std::size_t bytes;
};
// Indexed by location in the shaders.
constexpr std::array<Attribute, 6> kAttributes = {{
    {3, GL_FLOAT, offsetof(Vertex, position), sizeof(Vertex::position)},
    {3, GL_FLOAT, offsetof(Vertex, normal), sizeof(Vertex::normal)},
    {4, GL_FLOAT, offsetof(Vertex, tangent), sizeof(Vertex::tangent)},
    {2, GL_FLOAT, offsetof(Vertex, uv0), sizeof(Vertex::uv0)},
    {2, GL_FLOAT, offsetof(Vertex, uv1), sizeof(Vertex::uv1)},
    {4, GL_UNSIGNED_SHORT, offsetof(Vertex, color), sizeof(Vertex::color)},
}};
constexpr std::size_t kColorAttribute = 5;
// Instances for which an attribute keeps its value: more than are ever drawn at once.
constexpr GLuint kAllInstances = 1u << 30;
// Vertices that are packed at a time: they need no copy of the whole mesh.
constexpr std::size_t kPackedAtOnce = 1 << 16;

const char* bytes_of(const Vertex& vertex, const Attribute& attribute) {
  return reinterpret_cast<const char*>(&vertex) + attribute.offset;
}

// True if some vertex has another value than the first.
bool varies(const std::vector<Vertex>& vertices, const Attribute& attribute) {
  const char* const first = bytes_of(vertices.front(), attribute);
  return std::any_of(vertices.begin(), vertices.end(), [&](const Vertex& vertex) {
    return std::memcmp(bytes_of(vertex, attribute), first, attribute.bytes) != 0;
  });
}

void point_at(GLuint location, std::size_t offset, std::size_t stride, GLuint instances) {
  const Attribute& attribute = kAttributes[location];
  const GLboolean normalised = attribute.type == GL_UNSIGNED_SHORT ? GL_TRUE : GL_FALSE;
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, attribute.size, attribute.type, normalised,
                        static_cast<GLsizei>(stride), reinterpret_cast<const void*>(offset));
  glVertexAttribDivisor(location, instances);
}

// Fills the bound buffer with these attributes of each vertex.
void upload_packed(const std::vector<Vertex>& vertices, const std::vector<Attribute>& attributes,
                   std::size_t stride) {
  std::vector<char> packed;
  for (std::size_t first = 0; first < vertices.size(); first += kPackedAtOnce) {
    const std::size_t end = std::min(first + kPackedAtOnce, vertices.size());
    packed.resize((end - first) * stride);
    char* to = packed.data();
    for (std::size_t i = first; i < end; ++i) {
      for (const Attribute& attribute : attributes) {
        std::memcpy(to, bytes_of(vertices[i], attribute), attribute.bytes);
        to += attribute.bytes;
      }
    }
    glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(first * stride),
                    static_cast<GLsizeiptr>(packed.size()), packed.data());
  }
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

GpuMesh::GpuMesh(const Mesh& mesh, bool posed)
    : vao_(VertexArray::create()),
      vertices_(Buffer::create()),
      indices_(Buffer::create()),
      primitives_(mesh.primitives),
      vertex_color_(has_vertex_color(mesh)) {
  glBindVertexArray(vao_.id());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  upload_vertices(mesh.vertices, posed);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  const std::size_t index_bytes = mesh.indices.size() * sizeof(std::uint32_t);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(index_bytes), mesh.indices.data(),
               GL_STATIC_DRAW);
  glBindVertexArray(0);
  bytes_ += index_bytes;
}

// After the vertices lies one more, with the values that are the same at all.
void GpuMesh::upload_vertices(const std::vector<Vertex>& vertices, bool posed) {
  std::vector<Attribute> packed;
  std::array<bool, kAttributes.size()> own{};
  std::size_t stride = 0;
  for (std::size_t i = 0; i < kAttributes.size(); ++i) {
    const bool used = i != kColorAttribute || vertex_color_;
    own[i] = posed || (used && !vertices.empty() && varies(vertices, kAttributes[i]));
    if (own[i]) packed.push_back(kAttributes[i]);
    if (own[i]) stride += kAttributes[i].bytes;
  }
  const std::size_t constant_at = vertices.size() * stride;
  bytes_ = constant_at + (vertices.empty() ? 0 : sizeof(Vertex));
  const bool whole = stride == sizeof(Vertex);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes_), nullptr, GL_STATIC_DRAW);
  if (whole) {
    glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(constant_at), vertices.data());
  } else {
    upload_packed(vertices, packed, stride);
  }
  if (!vertices.empty()) {
    glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(constant_at), sizeof(Vertex),
                    vertices.data());
  }
  std::size_t offset = 0;
  for (GLuint i = 0; i < kAttributes.size(); ++i) {
    if (i == kColorAttribute && !vertex_color_) continue;
    point_at(i, own[i] ? offset : constant_at + kAttributes[i].offset,
             own[i] ? stride : sizeof(Vertex), own[i] ? 0 : kAllInstances);
    if (own[i]) offset += kAttributes[i].bytes;
  }
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
