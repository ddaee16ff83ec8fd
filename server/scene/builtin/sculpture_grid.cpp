// Closed surfaces given by a function of u and v.

#include <algorithm>
#include <cmath>

#include "server/scene/builtin/sculpture_mesh.h"

namespace mirage::builtin {
namespace {

constexpr float kMinGridTwiceArea = 2e-9f;  // m^2; thinner triangles, at the points, are dropped

/// Rows along v of `columns + 1` vertices; the last vertex repeats the position of the first.
class Grid {
 public:
  Grid(const GridSurface& surface, std::size_t triangles) : surface_(surface) {
    const float cells = static_cast<float>(triangles) * 0.5f;
    rows_ = std::max(4, static_cast<int>(std::sqrt(cells / surface.aspect) + 0.5f));
    columns_ = std::max(4, static_cast<int>(cells / static_cast<float>(rows_) + 0.5f));
  }

  Mesh take();

 private:
  Vertex& vertex(int column, int row) {
    return mesh_.vertices[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_ + 1) +
                          static_cast<std::size_t>(column)];
  }
  /// Returns the row after or before another one, across the seam or clamped at the points.
  int row_beside(int row, int step) const {
    const int other = row + step;
    if (!surface_.closes_along_v) return std::clamp(other, 0, rows_);
    return other < 0 ? rows_ - 1 : other > rows_ ? 1 : other;
  }
  void set_positions();
  void set_normals();
  void set_normals_of_point(int row, int inner_row);
  void set_triangles();
  void turn_outward();

  const GridSurface& surface_;
  int columns_;
  int rows_;
  Mesh mesh_;
};

void Grid::set_positions() {
  mesh_.vertices.resize(static_cast<std::size_t>(columns_ + 1) *
                        static_cast<std::size_t>(rows_ + 1));
  for (int j = 0; j <= rows_; ++j) {
    const float v = static_cast<float>(j) / static_cast<float>(rows_);
    const bool seam = surface_.closes_along_v && j == rows_;
    for (int i = 0; i <= columns_; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(columns_);
      Vertex& out = vertex(i, j);
      out.position = i == columns_ ? vertex(0, j).position
                     : seam        ? vertex(i, 0).position
                                   : surface_.at(u, v);
      out.uv0 = glm::vec2(u, v) * surface_.texture_repeats;
    }
  }
}

void Grid::set_normals() {
  for (int j = 0; j <= rows_; ++j) {
    for (int i = 0; i <= columns_; ++i) {
      const glm::vec3 along_u = vertex(i == columns_ ? 1 : i + 1, j).position -
                                vertex(i == 0 ? columns_ - 1 : i - 1, j).position;
      const glm::vec3 along_v =
          vertex(i, row_beside(j, 1)).position - vertex(i, row_beside(j, -1)).position;
      const glm::vec3 n = glm::cross(along_u, along_v);
      const float area = glm::length(n);
      Vertex& out = vertex(i, j);
      out.normal = area > 0 ? n / area : glm::vec3(0);
      const glm::vec3 flat = along_u - out.normal * glm::dot(out.normal, along_u);
      const float length = glm::length(flat);
      if (length > 0) out.tangent = glm::vec4(flat / length, 1);
    }
  }
  if (surface_.closes_along_v) return;
  set_normals_of_point(0, 1);
  set_normals_of_point(rows_, rows_ - 1);
}

// A row that is one point has no direction along u; its normal is the mean of the neighbouring row.
void Grid::set_normals_of_point(int row, int inner_row) {
  glm::vec3 sum(0);
  for (int i = 0; i < columns_; ++i) sum += vertex(i, inner_row).normal;
  const glm::vec3 n = glm::normalize(sum);
  for (int i = 0; i <= columns_; ++i) {
    Vertex& out = vertex(i, row);
    out.normal = n;
    const glm::vec3 t(vertex(i, inner_row).tangent);
    out.tangent = glm::vec4(glm::normalize(t - n * glm::dot(n, t)), 1);
  }
}

void Grid::set_triangles() {
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const glm::vec3 p = mesh_.vertices[a].position;
    const glm::vec3 n = glm::cross(mesh_.vertices[b].position - p, mesh_.vertices[c].position - p);
    if (glm::length(n) < kMinGridTwiceArea) return;
    mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
  };
  mesh_.indices.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) * 6);
  const auto row = static_cast<std::uint32_t>(columns_ + 1);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows_); ++j) {
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t k = j * row + i;
      add(k, k + 1, k + row + 1);
      add(k, k + row + 1, k + row);
    }
  }
}

void Grid::turn_outward() {
  double volume = 0;
  for (std::size_t i = 0; i < mesh_.indices.size(); i += 3) {
    const glm::dvec3 a = mesh_.vertices[mesh_.indices[i]].position;
    const glm::dvec3 b = mesh_.vertices[mesh_.indices[i + 1]].position;
    const glm::dvec3 c = mesh_.vertices[mesh_.indices[i + 2]].position;
    volume += glm::dot(a, glm::cross(b, c));
  }
  if (volume >= 0) return;
  for (std::size_t i = 0; i < mesh_.indices.size(); i += 3) {
    std::swap(mesh_.indices[i + 1], mesh_.indices[i + 2]);
  }
  for (Vertex& v : mesh_.vertices) {
    v.normal = -v.normal;
    v.tangent.w = -v.tangent.w;
  }
}

Mesh Grid::take() {
  set_positions();
  set_normals();
  set_triangles();
  turn_outward();
  Primitive whole;
  whole.index_count = static_cast<std::uint32_t>(mesh_.indices.size());
  mesh_.primitives = {whole};
  return std::move(mesh_);
}

}  // namespace

Mesh mesh_of(const GridSurface& surface, std::size_t triangles) {
  return Grid(surface, triangles).take();
}

}  // namespace mirage::builtin
