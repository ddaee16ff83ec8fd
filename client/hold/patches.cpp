#include "client/hold/patches.h"

#include <algorithm>
#include <numeric>

#include "client/scene/scene_view.h"
#include "protocol/impostor/camera.h"

namespace mirage {
namespace {

constexpr std::size_t kManyIndices = 3 * 4'096;
constexpr std::size_t kPatchTriangles = 128;
// The view is widened by this much: a picture at rest is drawn again, moved by parts of a pixel,
// and the edges of a scaled picture are rounded.
constexpr double kGuardPx = 2;

/// The box around points.
struct Box {
  glm::vec3 low, high;

  explicit Box(const glm::vec3& first) : low(first), high(first) {}
  void grow(const glm::vec3& to) {
    low = glm::min(low, to);
    high = glm::max(high, to);
  }
};

Patch patch_of(const Mesh& mesh, const IndexRun& run) {
  const auto at = [&](std::uint32_t i) { return mesh.vertices[mesh.indices[i]].position; };
  const std::uint32_t end = run.first + run.count;
  Box box(at(run.first));
  for (std::uint32_t i = run.first; i < end; ++i) box.grow(at(i));
  Patch out{run, 0.5f * (box.low + box.high), 0};
  for (std::uint32_t i = run.first; i < end; ++i) {
    out.radius = std::max(out.radius, glm::distance(out.center, at(i)));
  }
  out.radius *= 1.0001f;  // covers rounding
  return out;
}

/// Cuts the triangles of one primitive.
class Cutter {
 public:
  Cutter(Mesh& mesh, const Primitive& primitive)
      : mesh_(mesh),
        first_(primitive.first_index),
        before_(mesh.indices.begin() + first_,
                mesh.indices.begin() + first_ + primitive.index_count),
        order_(before_.size() / 3) {
    std::iota(order_.begin(), order_.end(), 0u);
    middles_.reserve(order_.size());
    for (std::size_t i = 0; i < before_.size(); i += 3) {
      const auto at = [&](std::size_t k) { return mesh.vertices[before_[i + k]].position; };
      middles_.push_back((at(0) + at(1) + at(2)) / 3.0f);
    }
  }

  void cut(std::vector<Patch>& out) { cut(0, order_.size(), out); }

 private:
  // Halves a range of triangles across its longest side, and each half again.
  void cut(std::size_t first, std::size_t count, std::vector<Patch>& out) {
    const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = begin + static_cast<std::ptrdiff_t>(count);
    if (count <= kPatchTriangles) {
      std::sort(begin, end);  // keeps neighbours together in the GPU's vertex cache
      return add(first, count, out);
    }
    Box box(middles_[*begin]);
    for (auto t = begin; t != end; ++t) box.grow(middles_[*t]);
    const glm::vec3 size = box.high - box.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t half = count / 2;
    std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(half), end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const float x = middles_[a][axis], y = middles_[b][axis];
                       return x != y ? x < y : a < b;
                     });
    cut(first, half, out);
    cut(first + half, count - half, out);
  }

  void add(std::size_t first, std::size_t count, std::vector<Patch>& out) {
    const IndexRun run{first_ + static_cast<std::uint32_t>(3 * first),
                       static_cast<std::uint32_t>(3 * count)};
    for (std::size_t i = 0; i < run.count; ++i) {
      mesh_.indices[run.first + i] = before_[3 * std::size_t{order_[first + i / 3]} + i % 3];
    }
    out.push_back(patch_of(mesh_, run));
  }

  Mesh& mesh_;
  const std::uint32_t first_;
  const std::vector<std::uint32_t> before_;
  std::vector<std::uint32_t> order_;
  std::vector<glm::vec3> middles_;
};

}  // namespace

std::vector<Patch> cut_into_patches(Mesh& mesh, const std::vector<Material>& materials) {
  std::vector<Patch> out;
  if (mesh.indices.size() < kManyIndices) return out;
  for (const Primitive& p : mesh.primitives) {
    if (p.index_count == 0) continue;
    const bool ordered = materials[p.material].alpha_mode == AlphaMode::kBlend;
    if (p.kind == PrimitiveKind::kTriangles && !ordered) {
      Cutter(mesh, p).cut(out);
    } else {
      out.push_back(patch_of(mesh, {p.first_index, p.index_count}));
    }
  }
  return out;
}

std::vector<IndexRun> runs_in_view(const std::vector<Patch>& patches, const InstanceView& instance,
                                   const Camera& camera) {
  const Similarity& pose = instance.world_from_object;
  const double scale = pose.scale;
  const glm::dmat3 turn = glm::mat3_cast(glm::dquat(pose.rotation));
  const glm::dvec3 origin = pose.position - camera.pose.eye;
  const Frustum frustum(camera, kGuardPx / camera.focal_px());
  std::vector<IndexRun> out;
  for (const Patch& patch : patches) {
    const glm::dvec3 center = origin + turn * (glm::dvec3(patch.center) * scale);
    if (!frustum.may_see(center, double{patch.radius} * scale)) continue;
    if (!out.empty() && out.back().first + out.back().count == patch.run.first) {
      out.back().count += patch.run.count;
    } else {
      out.push_back(patch.run);
    }
  }
  return out;
}

}  // namespace mirage
