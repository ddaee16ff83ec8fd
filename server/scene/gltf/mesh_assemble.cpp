#include "server/scene/gltf/mesh_assemble.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/scene/gltf/gltf_limits.h"

namespace mirage::gltf {
namespace {

// Between these extents, products of a few lengths stay far from the limits of float.
constexpr float kSmallestExtent = 1e-6f;
constexpr float kLargestExtent = 1e6f;
constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();

/// A primitive without normals has flat faces (glTF §3.7.2.1), each with its own corners: up to six
/// times the vertices. In one with more corners than this, faces are so small that smooth normals
/// look the same.
constexpr std::size_t kMostFlatCorners = 3'000'000;

bool splits_faces(const RawPrimitive& raw) {
  return raw.kind == PrimitiveKind::kTriangles && raw.normal.empty() &&
         raw.indices.size() <= kMostFlatCorners;
}

bool is_usable(const glm::vec3& p) {
  // Each comparison is false for NaN.
  return std::abs(p.x) <= kMaxPosition && std::abs(p.y) <= kMaxPosition &&
         std::abs(p.z) <= kMaxPosition;
}

/// Returns twice the area times the face normal. In double, differences of floats are exact enough
/// that a needle keeps its direction and 1e-30 m keeps its area.
glm::dvec3 face_vector(const RawPrimitive& raw, const std::uint32_t* corner) {
  const glm::dvec3 a(raw.position[corner[0]]);
  const glm::dvec3 b(raw.position[corner[1]]);
  const glm::dvec3 c(raw.position[corner[2]]);
  return glm::cross(b - a, c - a);
}

std::size_t corners(PrimitiveKind kind) {
  if (kind == PrimitiveKind::kTriangles) return 3;
  return kind == PrimitiveKind::kLines ? 2 : 1;
}

const char* noun(PrimitiveKind kind) {
  if (kind == PrimitiveKind::kTriangles) return "triangles";
  return kind == PrimitiveKind::kLines ? "lines" : "points";
}

/// Keeps the elements that can be drawn: existing vertices, usable positions, a non-zero area.
void filter_elements(RawPrimitive& raw, Tally& tally) {
  std::vector<bool> usable(raw.position.size());
  for (std::size_t i = 0; i < usable.size(); ++i) usable[i] = is_usable(raw.position[i]);
  const std::size_t size = corners(raw.kind);
  const std::size_t elements = raw.indices.size() / size;
  std::uint64_t beyond = 0;
  std::uint64_t not_finite = 0;
  std::uint64_t flat = 0;
  std::size_t kept = 0;
  for (std::size_t at = 0; at + size <= raw.indices.size(); at += size) {
    bool exists = true;
    bool finite = true;
    for (std::size_t c = 0; c < size; ++c) {
      const std::uint32_t index = raw.indices[at + c];
      exists = exists && index < usable.size();
      finite = finite && exists && usable[index];
    }
    if (!exists) {
      ++beyond;
    } else if (!finite) {
      ++not_finite;
    } else if (size == 3 && face_vector(raw, &raw.indices[at]) == glm::dvec3(0)) {
      ++flat;
    } else {
      for (std::size_t c = 0; c < size; ++c) raw.indices[kept + c] = raw.indices[at + c];
      kept += size;
    }
  }
  raw.indices.resize(kept);
  const std::string name = noun(raw.kind);
  tally.add(name + " with an index beyond the vertices dropped", beyond);
  tally.add(name + " with a position that is not finite or above 1e36 dropped", not_finite);
  // The poles of every ball have some.
  if (100 * flat > elements) tally.add(name + " without area dropped", flat);
}

template <typename T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& from) {
  if (values.empty()) return;
  std::vector<T> out(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) out[i] = values[from[i]];
  values = std::move(out);
}

void gather_all(RawPrimitive& raw, const std::vector<std::uint32_t>& from) {
  gather(raw.position, from);
  gather(raw.normal, from);
  gather(raw.tangent, from);
  gather(raw.uv0, from);
  gather(raw.uv1, from);
  gather(raw.color, from);
  gather(raw.source, from);
}

/// Gives each corner its own vertex, so that each face can have its own normal.
void split_faces(RawPrimitive& raw) {
  const std::vector<std::uint32_t> from = raw.indices;
  gather_all(raw, from);
  for (std::size_t i = 0; i < from.size(); ++i) raw.indices[i] = static_cast<std::uint32_t>(i);
  raw.tangent.clear();  // glTF §3.7.2.1: tangents without normals are ignored
  raw.normal.resize(from.size());
  for (std::size_t at = 0; at + 3 <= from.size(); at += 3) {
    const auto normal = glm::vec3(glm::normalize(face_vector(raw, &raw.indices[at])));
    for (std::size_t c = 0; c < 3; ++c) raw.normal[at + c] = normal;
  }
}

/// Removes unused vertices (a NaN among them would spoil the bounds) and keeps the order.
void compact(RawPrimitive& raw) {
  std::vector<std::uint32_t> place(raw.position.size(), kUnused);
  for (const std::uint32_t index : raw.indices) place[index] = 0;
  std::vector<std::uint32_t> from;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == kUnused) continue;
    place[i] = static_cast<std::uint32_t>(from.size());
    from.push_back(static_cast<std::uint32_t>(i));
  }
  if (from.size() == place.size()) return;
  gather_all(raw, from);
  for (std::uint32_t& index : raw.indices) index = place[index];
}

/// Replaces zero and NaN normals by the area-weighted normal of the faces around, and normalises
/// the rest.
void mend_normals(RawPrimitive& raw, std::string_view what, Tally& tally) {
  std::uint64_t bad = 0;
  for (const glm::vec3& normal : raw.normal) bad += has_direction(normal) ? 0 : 1;
  std::vector<glm::dvec3> sum;
  if (bad > 0 && raw.kind == PrimitiveKind::kTriangles) {
    sum.assign(raw.normal.size(), glm::dvec3(0));
    for (std::size_t at = 0; at + 3 <= raw.indices.size(); at += 3) {
      const glm::dvec3 face = face_vector(raw, &raw.indices[at]);
      for (std::size_t c = 0; c < 3; ++c) sum[raw.indices[at + c]] += face;
    }
  }
  for (std::size_t i = 0; i < raw.normal.size(); ++i) {
    glm::vec3 fallback(0, 0, 1);
    const double length = sum.empty() ? 0 : glm::length(sum[i]);
    if (length > 0) fallback = glm::vec3(sum[i] / length);
    raw.normal[i] = unit_or(raw.normal[i], fallback);
  }
  tally.add(what, bad);
}

/// Makes tangents from texture coordinates: accumulated per vertex, then orthogonalised (Lengyel,
/// "Computing Tangent Space Basis Vectors for an Arbitrary Mesh").
void make_tangents(RawPrimitive& raw, const std::vector<glm::vec2>& uv) {
  const std::size_t count = raw.position.size();
  std::vector<glm::dvec3> along_u(count, glm::dvec3(0));
  std::vector<glm::dvec3> along_v(count, glm::dvec3(0));
  for (std::size_t at = 0; at + 3 <= raw.indices.size(); at += 3) {
    const std::uint32_t* corner = &raw.indices[at];
    const glm::dvec3 origin(raw.position[corner[0]]);
    const glm::dvec3 edge1 = glm::dvec3(raw.position[corner[1]]) - origin;
    const glm::dvec3 edge2 = glm::dvec3(raw.position[corner[2]]) - origin;
    const glm::dvec2 uv1 = glm::dvec2(uv[corner[1]]) - glm::dvec2(uv[corner[0]]);
    const glm::dvec2 uv2 = glm::dvec2(uv[corner[2]]) - glm::dvec2(uv[corner[0]]);
    const double area = uv1.x * uv2.y - uv2.x * uv1.y;
    if (area == 0) continue;
    const double sign = area > 0 ? 1 : -1;  // its size cancels when normalised
    const glm::dvec3 u = sign * (edge1 * uv2.y - edge2 * uv1.y);
    const glm::dvec3 v = sign * (edge2 * uv1.x - edge1 * uv2.x);
    for (std::size_t c = 0; c < 3; ++c) {
      along_u[corner[c]] += u;
      along_v[corner[c]] += v;
    }
  }
  raw.tangent.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 normal(raw.normal[i]);
    const glm::dvec3 flat = along_u[i] - normal * glm::dot(normal, along_u[i]);
    const double length = glm::length(flat);
    const glm::vec3 tangent = length > 0 && std::isfinite(length) ? glm::vec3(flat / length)
                                                                  : perpendicular(raw.normal[i]);
    // glTF's bitangent points up the image, but v runs down it.
    const double turn = glm::dot(glm::cross(normal, along_u[i]), along_v[i]);
    raw.tangent[i] = glm::vec4(tangent, turn < 0 ? 1.0f : -1.0f);
  }
}

void mend_tangents(RawPrimitive& raw) {
  for (std::size_t i = 0; i < raw.tangent.size(); ++i) {
    const glm::vec3 direction = unit_or(glm::vec3(raw.tangent[i]), perpendicular(raw.normal[i]));
    raw.tangent[i] = glm::vec4(direction, raw.tangent[i].w < 0 ? -1.0f : 1.0f);
  }
}

/// Makes room for more values. The first of a mesh get as much as they need, so that a large
/// primitive is never in memory twice.
template <typename T>
void make_room(std::vector<T>& values, std::size_t more) {
  const std::size_t needed = values.size() + more;
  if (needed > values.capacity()) values.reserve(std::max(needed, 2 * values.size()));
}

Vertex vertex_of(const RawPrimitive& raw, std::size_t i) {
  Vertex out;
  out.position = raw.position[i];
  if (!raw.normal.empty()) out.normal = raw.normal[i];
  out.tangent = raw.tangent.empty() ? glm::vec4(perpendicular(out.normal), 1.0f) : raw.tangent[i];
  if (!raw.uv0.empty()) out.uv0 = raw.uv0[i];
  out.uv1 = raw.uv1.empty() ? out.uv0 : raw.uv1[i];
  if (!raw.color.empty()) out.color = raw.color[i];
  return out;
}

}  // namespace

std::size_t vertices_needed(const RawPrimitive& raw) {
  return splits_faces(raw) ? raw.indices.size() : raw.position.size();
}

bool has_tangents(const RawPrimitive& raw) {
  // glTF §3.7.2.1: tangents without normals are ignored.
  if (!raw.tangent.empty() && !raw.normal.empty()) return true;
  return raw.kind == PrimitiveKind::kTriangles && !(raw.uv0.empty() && raw.uv1.empty());
}

double normalise_extent(Mesh& mesh) {
  float most = 0;
  for (const Vertex& v : mesh.vertices) {
    most = std::max({most, std::abs(v.position.x), std::abs(v.position.y), std::abs(v.position.z)});
  }
  if (most == 0 || (most >= kSmallestExtent && most <= kLargestExtent)) return 1;
  const int exponent = std::ilogb(most);
  for (Vertex& v : mesh.vertices) {
    for (int c = 0; c < 3; ++c) v.position[c] = std::ldexp(v.position[c], -exponent);
  }
  return std::ldexp(1.0, exponent);
}

void append_primitive(RawPrimitive& raw, std::uint32_t material, bool needs_tangents, Tally& tally,
                      Mesh& mesh) {
  filter_elements(raw, tally);
  if (raw.indices.empty()) return;
  if (splits_faces(raw)) {
    split_faces(raw);
  } else {
    compact(raw);
    const bool none = raw.kind == PrimitiveKind::kTriangles && raw.normal.empty();
    if (none) raw.normal.assign(raw.position.size(), glm::vec3(0));
    const std::string_view what = none ? "vertices of large meshes without normals shaded smoothly"
                                       : "normals without direction replaced by face normals";
    if (!raw.normal.empty()) mend_normals(raw, what, tally);
  }
  if (!raw.tangent.empty() && !raw.normal.empty()) {
    mend_tangents(raw);
  } else {
    raw.tangent.clear();
    const auto& uv = raw.uv0.empty() ? raw.uv1 : raw.uv0;
    if (needs_tangents && raw.kind == PrimitiveKind::kTriangles && !uv.empty()) {
      make_tangents(raw, uv);
    }
  }
  Primitive primitive;
  primitive.kind = raw.kind;
  primitive.first_index = static_cast<std::uint32_t>(mesh.indices.size());
  primitive.index_count = static_cast<std::uint32_t>(raw.indices.size());
  primitive.material = material;
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  make_room(mesh.vertices, raw.position.size());
  make_room(mesh.indices, raw.indices.size());
  for (std::size_t i = 0; i < raw.position.size(); ++i) mesh.vertices.push_back(vertex_of(raw, i));
  for (const std::uint32_t index : raw.indices) mesh.indices.push_back(base + index);
  mesh.primitives.push_back(primitive);
}

}  // namespace mirage::gltf
