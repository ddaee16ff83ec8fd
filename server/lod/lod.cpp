#include "server/lod/lod.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "protocol/base/limits.h"
#include "protocol/impostor/lod.h"
#include "server/lod/foliage.h"
#include "server/lod/lod_chunks.h"
#include "server/lod/lod_shading.h"
#include "server/lod/seams.h"

namespace mirage {
namespace {

constexpr double kShare = 1.0 / 3.0;       // triangles of a level relative to the level before
constexpr double kWorthAnother = 0.85;     // a level that keeps more than this share is no gain
constexpr std::size_t kFewTriangles = 64;  // the chain ends at this size
// allowed error of the first level, share of the extent
constexpr double kFirstError = 0.002;
constexpr double kErrorGrowth = 2.5;          // of the allowed error, from level to level
constexpr double kMostError = 0.1;            // share of the extent beyond which the shape is lost
constexpr int kSteps = 12;                    // tries at fewer triangles; some give no level
constexpr double kLeastFoliage = 1.0 / 16.0;  // pieces are then four times as large
constexpr int kFruitless = 3;                 // steps without a level after which the chain ends

// Extracts a primitive on its own vertices. `places`: positions of the vertices with seams closed.
Part extract(const Mesh& mesh, const std::vector<glm::vec3>& places, const Primitive& primitive) {
  Part part{primitive.kind, primitive.material, {}, {}};
  std::vector<std::uint32_t> place(mesh.vertices.size(), UINT32_MAX);
  const bool triangles = primitive.kind == PrimitiveKind::kTriangles;
  const std::uint32_t count = triangles ? primitive.index_count / 3 * 3 : primitive.index_count;
  part.indices.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t v = mesh.indices[primitive.first_index + i];
    if (place[v] == UINT32_MAX) {
      place[v] = static_cast<std::uint32_t>(part.vertices.size());
      part.vertices.push_back(mesh.vertices[v]);
      part.vertices.back().position = places[v];
    }
    part.indices.push_back(place[v]);
  }
  return part;
}

void append(Mesh& mesh, const Part& part, const std::vector<Vertex>& vertices,
            const std::vector<std::uint32_t>& indices) {
  const auto first = static_cast<std::uint32_t>(mesh.indices.size());
  std::vector<std::uint32_t> place(vertices.size(), UINT32_MAX);
  for (const std::uint32_t i : indices) {
    if (place[i] == UINT32_MAX) {
      place[i] = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back(vertices[i]);
    }
    mesh.indices.push_back(place[i]);
  }
  mesh.primitives.push_back(
      {part.kind, first, static_cast<std::uint32_t>(indices.size()), part.material});
}

/// The chain of levels of one primitive.
class Chain {
 public:
  Chain(Part part, const Material& material, const Workers& workers)
      : workers_(workers), part_(std::move(part)), full_triangles_(part_.triangles()) {
    if (part_.kind != PrimitiveKind::kTriangles) return;
    if (material.double_sided || material.alpha_mode != AlphaMode::kOpaque) {
      pieces_ = pieces_of(part_);
      if (is_foliage(part_, pieces_)) return;
      pieces_.clear();
    }
    measure_from_here();
  }
  Chain(Chain&&) = delete;

  bool foliage() const { return !pieces_.empty(); }

  /// Adds this primitive to a level. Foliage comes first: surfaces may then have the error that it
  /// gave up (`out.spread`).
  void add_level(double share, double allowed, MeshLod& out) {
    if (part_.kind != PrimitiveKind::kTriangles) {
      append(out.mesh, part_, part_.vertices, part_.indices);
    } else if (foliage()) {
      const Thinned thin = thinned(part_, pieces_, std::max(share, kLeastFoliage));
      out.spread = std::max(out.spread, thin.spread);
      append(out.mesh, part_, thin.vertices, thin.indices);
    } else {
      simplify(share, std::max(allowed, double{out.spread} / kSpreadPerTau), out);
    }
  }

 private:
  void measure_from_here() {
    soup_ = is_soup(part_);
    if (part_.triangles() <= kLargeTriangles) {
      surface_.emplace(part_, LodRules{soup_, false, {}}, workers_);
    }
  }

  // Simplifies; the result is at most `allowed` object units from the full surface.
  void simplify(double share, double allowed, MeshLod& out) {
    const auto target =
        static_cast<std::size_t>(std::ceil(share * static_cast<double>(full_triangles_)));
    if (surface_) {
      surface_->reduce(target, allowed - base_error_, workers_);
      const Level& level = surface_->level(workers_);
      append(out.mesh, part_, level.vertices, level.indices);
    } else {
      ChunkedStep step = simplify_in_chunks(part_, target, allowed - base_error_, soup_, workers_);
      append(out.mesh, part_, step.shown.vertices, step.shown.indices);
      part_ = std::move(step.part);
      base_error_ += step.error;
      measure_from_here();
    }
    const double error = base_error_ + (surface_ ? surface_->error() : 0.0);
    out.error = std::max(out.error, static_cast<float>(error * 1.0001));
  }

  const Workers& workers_;
  Part part_;  ///< the full primitive; for a large one, the result of its last chunks
  std::size_t full_triangles_;
  std::vector<Piece> pieces_;  ///< of foliage only
  bool soup_ = false;
  double base_error_ = 0;              ///< of part_, object units
  std::optional<LodSurface> surface_;  ///< of part_; empty for foliage, and while part_ is large
};

double extent_of(const Mesh& mesh) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const std::uint32_t i : mesh.indices) {
    low = glm::min(low, mesh.vertices[i].position);
    high = glm::max(high, mesh.vertices[i].position);
  }
  return double{glm::length(high - low)};
}

std::size_t triangle_count(const Mesh& mesh) {
  std::size_t count = 0;
  for (const Primitive& p : mesh.primitives) {
    if (p.kind == PrimitiveKind::kTriangles) count += p.index_count / 3;
  }
  return count;
}

}  // namespace

std::vector<MeshLod> build_lods(const Mesh& full, const std::vector<Material>& materials,
                                const std::vector<Image>& images, const Workers& workers) {
  std::vector<MeshLod> lods;
  std::size_t triangles = triangle_count(full);
  if (triangles <= kFewTriangles) return lods;
  std::vector<std::unique_ptr<Chain>> chains(full.primitives.size());
  {
    const std::vector<glm::vec3> places = closed_positions(full.vertices);
    workers.each(chains.size(), [&](std::size_t i) {
      const Primitive& p = full.primitives[i];
      Part part = extract(full, places, p);
      if (part.indices.empty()) return;
      chains[i] = std::make_unique<Chain>(std::move(part), materials[p.material], workers);
    });
  }
  chains.erase(std::remove(chains.begin(), chains.end(), nullptr), chains.end());
  std::stable_partition(chains.begin(), chains.end(),
                        [](const std::unique_ptr<Chain>& chain) { return chain->foliage(); });
  std::optional<MeshShading> shading;  // of the full mesh, if a level is compared with it
  double share = 1, allowed = kFirstError * extent_of(full);
  const double most = kMostError * extent_of(full);
  int fruitless = 0;
  for (int i = 0; i < kSteps && lods.size() + 1 < limits::kMaxLods; ++i) {
    share *= kShare;
    MeshLod lod;
    for (const std::unique_ptr<Chain>& chain : chains) chain->add_level(share, allowed, lod);
    allowed = std::min(allowed * kErrorGrowth, most);
    const std::size_t left = triangle_count(lod.mesh);
    if (static_cast<double>(left) > kWorthAnother * static_cast<double>(triangles)) {
      if (++fruitless == kFruitless) break;
      continue;
    }
    fruitless = 0;
    triangles = left;
    if (lod.spread == 0) {
      if (!shading) shading.emplace(full, materials, images, workers);
      lod.shading = shading->size_of(lod.mesh);
    }
    lods.push_back(std::move(lod));
    if (triangles <= kFewTriangles) break;
  }
  return lods;
}

}  // namespace mirage
