#include "server/scene/builtin/mesh_builder.h"

#include <array>
#include <cmath>

#include "server/scene/builtin/tau.h"

namespace mirage::builtin {
namespace {

constexpr float kKinkCosine = 0.766f;   // 40 degrees
constexpr float kMinTwiceArea = 2e-9f;  // m^2; thinner triangles are dropped

float linear_of_byte(std::uint32_t byte) {
  const float c = static_cast<float>(byte) / 255.0f;
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

glm::vec3 any_orthogonal(glm::vec3 n) {
  const glm::vec3 axis = std::abs(n.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  return glm::normalize(glm::cross(axis, n));
}

}  // namespace

glm::vec3 rgb(std::uint32_t srgb_hex) {
  return {linear_of_byte((srgb_hex >> 16) & 255), linear_of_byte((srgb_hex >> 8) & 255),
          linear_of_byte(srgb_hex & 255)};
}

MeshBuilder& MeshBuilder::use(std::uint32_t material) {
  material_ = material;
  if (indices_of_material_.size() <= material) indices_of_material_.resize(material + 1);
  return *this;
}

MeshBuilder& MeshBuilder::paint(glm::vec3 linear_color) {
  color_ = linear_color;
  return *this;
}

MeshBuilder& MeshBuilder::place(const glm::mat4& object_from_part) {
  transform_ = object_from_part;
  normal_transform_ = glm::transpose(glm::inverse(glm::mat3(object_from_part)));
  return *this;
}

std::uint32_t MeshBuilder::vertex(glm::vec3 position, glm::vec3 normal, glm::vec2 uv) {
  Vertex v;
  v.position = glm::vec3(transform_ * glm::vec4(position, 1));
  v.normal = glm::normalize(normal_transform_ * normal);
  v.uv0 = uv;
  const glm::vec3 c = glm::clamp(color_, 0.0f, 1.0f) * 65535.0f + 0.5f;
  v.color = glm::u16vec4(glm::u16vec3(c), 65535);
  vertices_.push_back(v);
  return vertex_count() - 1;
}

void MeshBuilder::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (indices_of_material_.size() <= material_) indices_of_material_.resize(material_ + 1);
  const glm::vec3 p = vertices_[a].position;
  const glm::vec3 n = glm::cross(vertices_[b].position - p, vertices_[c].position - p);
  if (glm::dot(n, n) < kMinTwiceArea * kMinTwiceArea) return;
  auto& list = indices_of_material_[material_];
  list.insert(list.end(), {a, b, c});
}

void MeshBuilder::quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  triangle(a, b, c);
  triangle(a, c, d);
}

void MeshBuilder::face(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, glm::vec2 uv_scale) {
  const glm::vec3 n = glm::cross(c - a, d - b);
  const std::uint32_t i = vertex(a, n, glm::vec2(0, 0));
  vertex(b, n, glm::vec2(uv_scale.x, 0));
  vertex(c, n, uv_scale);
  vertex(d, n, glm::vec2(0, uv_scale.y));
  quad(i, i + 1, i + 2, i + 3);
}

void MeshBuilder::grid_face(glm::vec3 a, glm::vec3 b, glm::vec3 d, int nu, int nv,
                            glm::vec2 uv_scale) {
  const glm::vec3 n = glm::cross(b - a, d - a);
  const std::uint32_t first = vertex_count();
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i <= nu; ++i) {
      const glm::vec2 t(static_cast<float>(i) / static_cast<float>(nu),
                        static_cast<float>(j) / static_cast<float>(nv));
      vertex(a + (b - a) * t.x + (d - a) * t.y, n, t * uv_scale);
    }
  }
  const auto row = static_cast<std::uint32_t>(nu + 1);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(nv); ++j) {
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t k = first + j * row + i;
      quad(k, k + 1, k + row + 1, k + row);
    }
  }
}

void MeshBuilder::box(glm::vec3 l, glm::vec3 h) {
  face({l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z});
  face({h.x, l.y, l.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z});
  face({h.x, l.y, h.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z});
  face({l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z});
  face({l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z});
  face({l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z});
}

void MeshBuilder::rounded_box(glm::vec3 low, glm::vec3 high, float radius, int steps) {
  const glm::vec3 center = (low + high) * 0.5f;
  const glm::vec3 half = (high - low) * 0.5f;
  const float r = glm::min(radius, 0.999f * glm::min(half.x, glm::min(half.y, half.z)));
  const glm::vec3 inner = half - r;
  const auto lines = static_cast<std::uint32_t>(2 * steps + 2);
  // Grid line k of an axis: the first half of the lines round the low edge, the rest the high one.
  const auto line = [&](std::uint32_t k, int axis) {
    const int i = static_cast<int>(k);
    const float side = i <= steps ? -1.0f : 1.0f;
    const int from_edge = i <= steps ? i : 2 * steps + 1 - i;
    // Tangent spacing puts the facets at equal angles.
    const float angle = 0.785398f * static_cast<float>(steps - from_edge);
    return side * (inner[axis] + r * std::tan(angle / static_cast<float>(steps)));
  };
  for (int face_index = 0; face_index < 6; ++face_index) {
    const int axis = face_index / 2;
    const float sign = face_index % 2 == 0 ? 1.0f : -1.0f;
    const int u = (axis + (sign > 0 ? 1 : 2)) % 3;
    const int v = (axis + (sign > 0 ? 2 : 1)) % 3;
    const std::uint32_t first = vertex_count();
    for (std::uint32_t j = 0; j < lines; ++j) {
      for (std::uint32_t i = 0; i < lines; ++i) {
        glm::vec3 p;
        p[axis] = sign * half[axis];
        p[u] = line(i, u);
        p[v] = line(j, v);
        const glm::vec3 q = glm::clamp(p, -inner, inner);
        const glm::vec3 n = glm::normalize(p - q);
        vertex(center + q + n * r, n, {p[u] / (2 * half[u]) + 0.5f, p[v] / (2 * half[v]) + 0.5f});
      }
    }
    for (std::uint32_t j = 0; j + 1 < lines; ++j) {
      for (std::uint32_t i = 0; i + 1 < lines; ++i) {
        const std::uint32_t k = first + j * lines + i;
        quad(k, k + 1, k + lines + 1, k + lines);
      }
    }
  }
}

void MeshBuilder::lathe(std::span<const glm::vec2> profile, int segments) {
  const std::size_t spans = profile.size() - 1;
  std::vector<glm::vec2> normals(spans);
  for (std::size_t i = 0; i < spans; ++i) {
    const glm::vec2 d = glm::normalize(profile[i + 1] - profile[i]);
    normals[i] = {d.y, -d.x};
  }
  const auto smooth = [&](std::size_t i, std::size_t neighbour) {
    return glm::dot(normals[i], normals[neighbour]) < kKinkCosine
               ? normals[i]
               : glm::normalize(normals[i] + normals[neighbour]);
  };
  const auto row = static_cast<std::uint32_t>(segments + 1);
  for (std::size_t i = 0; i < spans; ++i) {
    const glm::vec2 ends[2] = {i > 0 ? smooth(i, i - 1) : normals[i],
                               i + 1 < spans ? smooth(i, i + 1) : normals[i]};
    const std::uint32_t first = vertex_count();
    for (std::size_t e = 0; e < 2; ++e) {
      const glm::vec2 p = profile[i + e];
      const float v = static_cast<float>(i + e) / static_cast<float>(spans);
      for (int s = 0; s <= segments; ++s) {
        const float t = static_cast<float>(s % segments) / static_cast<float>(segments);
        const float c = std::cos(t * kTau);
        const float w = std::sin(t * kTau);
        vertex({p.x * c, p.y, p.x * w}, {ends[e].x * c, ends[e].y, ends[e].x * w},
               {static_cast<float>(s) / static_cast<float>(segments), v});
      }
    }
    for (std::uint32_t s = 0; s + 1 < row; ++s) {
      quad(first + s, first + row + s, first + row + s + 1, first + s + 1);
    }
  }
}

void MeshBuilder::cylinder(glm::vec3 base, float radius, float height, int segments) {
  const glm::mat4 saved = transform_;
  place(glm::translate(saved, base));
  const std::array<glm::vec2, 4> profile = {{{0, 0}, {radius, 0}, {radius, height}, {0, height}}};
  lathe(profile, segments);
  place(saved);
}

void MeshBuilder::sphere(glm::vec3 center, glm::vec3 radii, int rings, int segments) {
  const glm::mat4 saved = transform_;
  place(glm::scale(glm::translate(saved, center), radii));
  const std::uint32_t first = vertex_count();
  const auto row = static_cast<std::uint32_t>(segments + 1);
  for (int j = 0; j <= rings; ++j) {
    const float v = static_cast<float>(j) / static_cast<float>(rings);
    const float y = j == rings ? 1.0f : -std::cos(v * kTau * 0.5f);
    const float r = j == 0 || j == rings ? 0.0f : std::sin(v * kTau * 0.5f);
    for (int s = 0; s <= segments; ++s) {
      const float a = static_cast<float>(s % segments) / static_cast<float>(segments) * kTau;
      const glm::vec3 p(r * std::cos(a), y, r * std::sin(a));
      vertex(p, p, {static_cast<float>(s) / static_cast<float>(segments), v});
    }
  }
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rings); ++j) {
    for (std::uint32_t s = 0; s + 1 < row; ++s) {
      const std::uint32_t k = first + j * row + s;
      quad(k, k + row, k + row + 1, k + 1);
    }
  }
  place(saved);
}

void MeshBuilder::tube(std::span<const glm::vec3> path, std::span<const float> radii, int sides,
                       float v_per_m) {
  const std::size_t n = path.size();
  const std::uint32_t first = vertex_count();
  const auto row = static_cast<std::uint32_t>(sides + 1);
  glm::vec3 side(0);
  float length = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::vec3 along = glm::normalize(path[i + 1 < n ? i + 1 : i] - path[i > 0 ? i - 1 : 0]);
    // Parallel transport keeps the rings from twisting against each other.
    side -= along * glm::dot(side, along);
    side = glm::dot(side, side) < 1e-6f ? any_orthogonal(along) : glm::normalize(side);
    const glm::vec3 other = glm::cross(side, along);
    if (i > 0) length += glm::length(path[i] - path[i - 1]);
    for (int s = 0; s <= sides; ++s) {
      const float a = static_cast<float>(s % sides) / static_cast<float>(sides) * kTau;
      const glm::vec3 out = side * std::cos(a) + other * std::sin(a);
      vertex(path[i] + out * radii[i], out,
             {static_cast<float>(s) / static_cast<float>(sides), length * v_per_m});
    }
  }
  for (std::uint32_t i = 0; i + 1 < n; ++i) {
    for (std::uint32_t s = 0; s + 1 < row; ++s) {
      const std::uint32_t k = first + i * row + s;
      quad(k, k + row, k + row + 1, k + 1);
    }
  }
}

void MeshBuilder::rod(glm::vec3 from, glm::vec3 to, float radius, int sides) {
  const glm::vec3 step = (to - from) * 1e-3f;
  const std::array<glm::vec3, 4> path = {from, from + step, to - step, to};
  const std::array<float, 4> radii = {0, radius, radius, 0};
  tube(path, radii, sides);
}

Mesh MeshBuilder::take() {
  Mesh mesh;
  for (std::uint32_t m = 0; m < indices_of_material_.size(); ++m) {
    const auto& list = indices_of_material_[m];
    if (list.empty()) continue;
    Primitive primitive;
    primitive.first_index = static_cast<std::uint32_t>(mesh.indices.size());
    primitive.index_count = static_cast<std::uint32_t>(list.size());
    primitive.material = m;
    mesh.primitives.push_back(primitive);
    mesh.indices.insert(mesh.indices.end(), list.begin(), list.end());
  }
  for (Vertex& v : vertices_) v.tangent = glm::vec4(any_orthogonal(v.normal), 1);
  mesh.vertices = std::move(vertices_);
  *this = MeshBuilder();
  return mesh;
}

}  // namespace mirage::builtin
