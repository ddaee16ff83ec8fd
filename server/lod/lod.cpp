#include "server/lod/lod.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "protocol/base/limits.h"
#include "protocol/impostor/lod.h"
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
constexpr std::size_t kFoliagePieces = 8;     // fewer pieces are visible one by one
constexpr std::size_t kPieceTriangles = 64;   // pieces with a larger mean are surfaces
constexpr double kLeastFoliage = 1.0 / 16.0;  // pieces are then four times as large
constexpr int kFruitless = 3;                 // steps without a level after which the chain ends
constexpr std::size_t kSampledPieces = 2'000;
// An enlarged piece stays hidden among others unless it grows by this many times the way to the
// next.
constexpr float kSeenGrowth = 3;

/// A connected component of foliage.
struct Piece {
  std::vector<std::uint32_t> triangles;
  glm::vec3 middle{0};
  float radius = 0;  ///< from the middle to the farthest corner
  double rank = 0;   ///< in [0, 1); pieces of the lowest ranks stay longest
};

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

std::uint64_t hash(std::uint64_t i) {  // splitmix64
  i = (i + 1) * 0x9e3779b97f4a7c15ull;
  i = (i ^ (i >> 30)) * 0xbf58476d1ce4e5b9ull;
  i = (i ^ (i >> 27)) * 0x94d049bb133111ebull;
  return i ^ (i >> 31);
}

void rank_by_hash(std::vector<Piece>& pieces) {
  std::vector<std::size_t> order(pieces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [](std::size_t a, std::size_t b) { return hash(a) < hash(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    pieces[order[i]].rank = static_cast<double>(i) / static_cast<double>(order.size());
  }
}

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Returns the components connected through equal positions, in the order of their first triangle.
std::vector<Piece> pieces_of(const Part& part) {
  std::vector<std::uint32_t> welded(part.indices.size());
  meshopt_generateShadowIndexBuffer(welded.data(), part.indices.data(), part.indices.size(),
                                    part.vertices.data(), part.vertices.size(), sizeof(glm::vec3),
                                    sizeof(Vertex));
  std::vector<std::uint32_t> parent(part.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  for (std::size_t t = 0; t + 2 < welded.size(); t += 3) {
    const std::uint32_t a = root_of(parent, welded[t]);
    parent[root_of(parent, welded[t + 1])] = a;
    parent[root_of(parent, welded[t + 2])] = a;
  }
  std::vector<std::uint32_t> piece_of_root(part.vertices.size(), UINT32_MAX);
  std::vector<Piece> pieces;
  for (std::uint32_t t = 0; t < welded.size() / 3; ++t) {
    std::uint32_t& piece = piece_of_root[root_of(parent, welded[3 * std::size_t{t}])];
    if (piece == UINT32_MAX) {
      piece = static_cast<std::uint32_t>(pieces.size());
      pieces.emplace_back();
    }
    pieces[piece].triangles.push_back(t);
  }
  for (Piece& piece : pieces) {
    glm::dvec3 sum(0);
    for (const std::uint32_t t : piece.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        sum += glm::dvec3(part.vertices[part.indices[3 * std::size_t{t} + k]].position);
      }
    }
    piece.middle = glm::vec3(sum / (3.0 * static_cast<double>(piece.triangles.size())));
    for (const std::uint32_t t : piece.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vertex& v = part.vertices[part.indices[3 * std::size_t{t} + k]];
        piece.radius = std::max(piece.radius, glm::length(v.position - piece.middle));
      }
    }
  }
  rank_by_hash(pieces);
  return pieces;
}

bool is_foliage(const Part& part, const std::vector<Piece>& pieces) {
  return pieces.size() >= kFoliagePieces && part.triangles() <= pieces.size() * kPieceTriangles;
}

/// Returns the distance within which 95 % of the dropped pieces have a kept one.
float spread_of(const std::vector<Piece>& pieces, double share) {
  std::vector<glm::vec3> kept;
  for (const Piece& piece : pieces) {
    if (piece.rank < share) kept.push_back(piece.middle);
  }
  std::vector<float> distances;
  const std::size_t step = std::max<std::size_t>(1, pieces.size() / kSampledPieces);
  for (std::size_t i = 0; i < pieces.size(); i += step) {
    if (pieces[i].rank < share) continue;
    float best2 = INFINITY;
    for (const glm::vec3& k : kept) {
      const glm::vec3 d = k - pieces[i].middle;
      best2 = std::min(best2, glm::dot(d, d));
    }
    distances.push_back(std::sqrt(best2));
  }
  if (distances.empty()) return 0;
  const std::size_t at = distances.size() * 95 / 100;
  std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(at),
                   distances.end());
  return distances[at];
}

/// Returns the distance within which 95 % of the pieces end that are enlarged by `scale`, from
/// where they ended before.
float growth_of(const std::vector<Piece>& pieces, double scale) {
  std::vector<float> radii;
  for (const Piece& piece : pieces) radii.push_back(piece.radius);
  const auto at = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() * 95 / 100);
  std::nth_element(radii.begin(), at, radii.end());
  return static_cast<float>((scale - 1) * double{*at});
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
      thin(std::max(share, kLeastFoliage), out);
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

  void thin(double share, MeshLod& out) const {
    std::size_t kept = 0;
    for (const Piece& piece : pieces_) kept += piece.rank < share;
    const double scale = std::sqrt(static_cast<double>(pieces_.size()) / static_cast<double>(kept));
    std::vector<Vertex> vertices = part_.vertices;
    std::vector<std::uint32_t> indices;
    std::vector<bool> moved(vertices.size(), false);
    for (const Piece& piece : pieces_) {
      if (!(piece.rank < share)) continue;
      for (const std::uint32_t t : piece.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = part_.indices[3 * std::size_t{t} + k];
          indices.push_back(v);
          if (moved[v]) continue;
          moved[v] = true;
          vertices[v].position =
              piece.middle + static_cast<float>(scale) * (vertices[v].position - piece.middle);
        }
      }
    }
    const float spread = spread_of(pieces_, share), growth = growth_of(pieces_, scale);
    out.spread = std::max(out.spread, growth > kSeenGrowth * spread ? growth : spread);
    append(out.mesh, part_, vertices, indices);
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
