// Surface nets over a signed distance, plane by plane: only two planes of samples are held.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "server/scene/builtin/sculpture_mesh.h"

namespace mirage::builtin {
namespace {

constexpr int kSolidBlock = 4;     // samples a side that are skipped together
constexpr float kSteepest = 1.5f;  // largest slope of the distances of solids
constexpr std::uint32_t kNoVertex = 0xffffffff;
constexpr int kTrialCells = 72;  // along the longest side, for a first count of triangles
constexpr int kAttempts = 3;
constexpr double kCloseEnough = 0.06;  // relative to the triangles asked for

class Nets {
 public:
  Nets(const Solid& solid, int longest) : solid_(solid) {
    const glm::vec3 size = solid.half_extent * 2.0f;
    cell_ = std::max(size.x, std::max(size.y, size.z)) / static_cast<float>(longest);
    cells_ = glm::ivec3(glm::ceil(size / cell_)) + 2;
    low_ = -0.5f * cell_ * glm::vec3(cells_);
    for (auto& plane : samples_) plane.resize(plane_size());
    for (auto& plane : vertex_of_cell_) plane.assign(plane_size(), kNoVertex);
  }

  Mesh take() {
    sample(0);
    for (int z = 0; z < cells_.z; ++z) {
      sample(z + 1);
      add_vertices(z);
      add_quads(z);
    }
    return std::move(mesh_);
  }

 private:
  std::size_t plane_size() const {
    return static_cast<std::size_t>(cells_.x + 1) * static_cast<std::size_t>(cells_.y + 1);
  }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_.x + 1) +
           static_cast<std::size_t>(x);
  }
  glm::vec3 point(int x, int y, int z) const { return low_ + cell_ * glm::vec3(x, y, z); }
  float value(int x, int y, int z) const {
    return samples_[static_cast<std::size_t>(z & 1)][at(x, y)];
  }
  std::uint32_t& vertex(int x, int y, int z) {
    return vertex_of_cell_[static_cast<std::size_t>(z & 1)][at(x, y)];
  }

  void sample(int z);
  void add_vertices(int z);
  void add_vertex(glm::vec3 p);
  void add_quads(int z);
  void add_quad(std::array<std::uint32_t, 4> corners, bool forward);

  const Solid& solid_;
  float cell_ = 1;
  glm::ivec3 cells_{0};
  glm::vec3 low_{0};
  std::array<std::vector<float>, 2> samples_;
  std::array<std::vector<std::uint32_t>, 2> vertex_of_cell_;
  std::vector<float> middles_;  // of the blocks that contain the plane
  Mesh mesh_;
};

void Nets::sample(int z) {
  const int across = cells_.x / kSolidBlock + 1;
  const int down = cells_.y / kSolidBlock + 1;
  const float middle = 0.5f * static_cast<float>(kSolidBlock - 1);
  if (z % kSolidBlock == 0) {
    middles_.clear();
    for (int by = 0; by < down; ++by) {
      for (int bx = 0; bx < across; ++bx) {
        middles_.push_back(solid_.distance(
            low_ + cell_ * (glm::vec3(bx * kSolidBlock, by * kSolidBlock, z) + middle)));
      }
    }
  }
  // Distance to a block's farthest sample, plus one cell so that neighbours agree on their signs.
  const float reach = kSteepest * cell_ * 1.7321f * (middle + 1);
  std::vector<float>& plane = samples_[static_cast<std::size_t>(z & 1)];
  for (int y = 0; y <= cells_.y; ++y) {
    for (int x = 0; x <= cells_.x; ++x) {
      const float d =
          middles_[static_cast<std::size_t>((y / kSolidBlock) * across + x / kSolidBlock)];
      const bool border =
          x == 0 || y == 0 || z == 0 || x == cells_.x || y == cells_.y || z == cells_.z;
      plane[at(x, y)] = border ? cell_ : std::abs(d) > reach ? d : solid_.distance(point(x, y, z));
    }
  }
}

void Nets::add_vertices(int z) {
  for (int y = 0; y < cells_.y; ++y) {
    for (int x = 0; x < cells_.x; ++x) {
      std::array<float, 8> d;
      int inside = 0;
      for (int k = 0; k < 8; ++k) {
        d[static_cast<std::size_t>(k)] = value(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2));
        inside += d[static_cast<std::size_t>(k)] < 0;
      }
      vertex(x, y, z) = kNoVertex;
      if (inside == 0 || inside == 8) continue;
      glm::vec3 sum(0);
      float crossings = 0;
      for (int a = 0; a < 8; ++a) {
        for (int axis = 1; axis < 8; axis *= 2) {
          if ((a & axis) != 0) continue;
          const int b = a | axis;
          const float da = d[static_cast<std::size_t>(a)];
          const float db = d[static_cast<std::size_t>(b)];
          if ((da < 0) == (db < 0)) continue;
          const glm::vec3 from(a & 1, a >> 1 & 1, a >> 2);
          const glm::vec3 to(b & 1, b >> 1 & 1, b >> 2);
          sum += glm::mix(from, to, da / (da - db));
          crossings += 1;
        }
      }
      vertex(x, y, z) = static_cast<std::uint32_t>(mesh_.vertices.size());
      add_vertex(point(x, y, z) + cell_ * sum / crossings);
    }
  }
}

// One Newton step moves the vertex onto the surface; without it the grid is visible.
void Nets::add_vertex(glm::vec3 p) {
  // The samples are at the corners of a tetrahedron: four of them give both gradient and mean.
  constexpr std::array<glm::vec3, 4> kCorners = {
      {{1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {1, 1, 1}}};
  const float h = 0.4f * cell_;
  glm::vec3 gradient(0);
  float mean = 0;
  for (const glm::vec3& corner : kCorners) {
    const float d = solid_.distance(p + corner * h);
    gradient += corner * d / (4 * h);
    mean += 0.25f * d;
  }
  const float steepness = glm::length(gradient);
  Vertex v;
  v.normal = steepness > 1e-4f ? gradient / steepness : glm::vec3(0, 1, 0);
  const float off = mean / std::max(steepness, 0.3f);
  v.position = p - v.normal * glm::clamp(off, -0.5f * cell_, 0.5f * cell_);
  const glm::vec3 axis = std::abs(v.normal.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  v.tangent = glm::vec4(glm::normalize(glm::cross(axis, v.normal)), 1);
  const glm::vec3 q = v.position / solid_.half_extent;
  // The radius keeps flat-lying faces from being a single streak.
  v.uv0 = glm::vec2(std::atan2(std::abs(q.z), q.x) * 0.31831f,
                    0.5f - 0.5f * q.y + 0.4f * glm::length(glm::vec2(q.x, q.z))) *
          solid_.texture_repeats;
  mesh_.vertices.push_back(v);
}

void Nets::add_quad(std::array<std::uint32_t, 4> q, bool forward) {
  if (!forward) std::swap(q[1], q[3]);
  const auto between = [&](std::size_t a, std::size_t b) {
    const glm::vec3 d = mesh_.vertices[q[a]].position - mesh_.vertices[q[b]].position;
    return glm::dot(d, d);
  };
  auto& out = mesh_.indices;
  if (between(0, 2) <= between(1, 3)) {
    out.insert(out.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
  } else {
    out.insert(out.end(), {q[1], q[2], q[3], q[1], q[3], q[0]});
  }
}

// Adds one quad for each grid edge that the surface cuts, through the four cells about it.
void Nets::add_quads(int z) {
  for (int y = 1; y < cells_.y; ++y) {
    for (int x = 1; x < cells_.x; ++x) {
      const bool inside = value(x, y, z) < 0;
      if (z > 0 && inside != (value(x + 1, y, z) < 0)) {
        add_quad(
            {vertex(x, y - 1, z - 1), vertex(x, y, z - 1), vertex(x, y, z), vertex(x, y - 1, z)},
            inside);
      }
      if (z > 0 && inside != (value(x, y + 1, z) < 0)) {
        add_quad(
            {vertex(x - 1, y, z - 1), vertex(x - 1, y, z), vertex(x, y, z), vertex(x, y, z - 1)},
            inside);
      }
      if (inside != (value(x, y, z + 1) < 0)) {
        add_quad(
            {vertex(x - 1, y - 1, z), vertex(x, y - 1, z), vertex(x, y, z), vertex(x - 1, y, z)},
            inside);
      }
    }
  }
}

}  // namespace

Mesh mesh_of(const Solid& solid, std::size_t triangles) {
  Mesh mesh;
  double longest = kTrialCells;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    mesh = Nets(solid, std::max(8, static_cast<int>(longest + 0.5))).take();
    const double ratio = static_cast<double>(triangles) /
                         static_cast<double>(std::max<std::size_t>(mesh.indices.size() / 3, 1));
    if (std::abs(ratio - 1) < kCloseEnough) break;
    // The number of triangles grows with the square of the cells along a side.
    longest *= std::sqrt(ratio);
  }
  Primitive whole;
  whole.index_count = static_cast<std::uint32_t>(mesh.indices.size());
  mesh.primitives = {whole};
  return mesh;
}

}  // namespace mirage::builtin
