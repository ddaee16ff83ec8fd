#include "server/lod/lod_surface.h"

#include <meshoptimizer.h>

namespace mirage {
namespace {

// tries to keep the limit, because the simplifier only estimates
constexpr int kTries = 4;
// Shares of the allowed error that the simplifier's estimate may take, since estimates fall short.
constexpr double kFirstShare = 0.85, kNextShare = 0.6;
constexpr double kWorthTaking = 0.85;        // a step that keeps more than this share is no gain
constexpr std::size_t kSoupIndices = 3'000;  // smaller parts may have hard edges on purpose
constexpr double kSoupShare = 0.8;           // vertices per index; a box of quads has 0.67

// A part with vertices joined that differ only in normal and tangent. Only positions matter here:
// each level takes its normals from the full surface.
struct Welded {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint32_t> origin;  // by vertex: one of the part's vertices joined in it
};

Welded welded(const Part& part) {
  const meshopt_Stream streams[] = {
      {&part.vertices[0].position, sizeof(glm::vec3), sizeof(Vertex)},
      {&part.vertices[0].uv0, 2 * sizeof(glm::vec2) + sizeof(glm::u16vec4), sizeof(Vertex)}};
  std::vector<std::uint32_t> remap(part.vertices.size());
  const std::size_t count = meshopt_generateVertexRemapMulti(
      remap.data(), part.indices.data(), part.indices.size(), remap.size(), streams, 2);
  Welded out{std::vector<Vertex>(count), {}, std::vector<std::uint32_t>(count)};
  for (std::uint32_t i = 0; i < remap.size(); ++i) {
    out.vertices[remap[i]] = part.vertices[i];
    out.origin[remap[i]] = i;
  }
  for (const std::uint32_t i : part.indices) out.indices.push_back(remap[i]);
  return out;
}

}  // namespace

bool is_soup(const Part& part) {
  return part.indices.size() >= kSoupIndices &&
         static_cast<double>(part.vertices.size()) >
             kSoupShare * static_cast<double>(part.indices.size());
}

LodSurface::LodSurface(const Part& part, const LodRules& rules, const Workers& workers)
    : part_(part), coarse_(part.indices) {
  if (rules.soup) {
    Welded joined = welded(part);
    simplifier_.emplace(joined.vertices, std::move(joined.indices), rules.lock_border);
    origin_ = std::move(joined.origin);
  } else {
    simplifier_.emplace(part.vertices, part.indices, rules.lock_border);
  }
  surface_.emplace(part.vertices, part.indices, simplifier_->scale(), rules.samples, workers);
}

bool LodSurface::reduce(std::size_t triangles, double allowed, const Workers& workers) {
  const std::size_t target = 3 * triangles;
  if (stuck_at_ == allowed) return false;
  bool limited = coarse_.size() > target;  // by the error: fewer `triangles` would change nothing
  double share = kFirstShare;
  for (int i = 0; i < kTries && coarse_.size() > target; ++i, share *= kNextShare) {
    const double aim = share * allowed - estimate_;
    if (!(aim > 0)) break;
    SurfaceSimplifier::Step step = simplifier_->simplified(target, aim);
    // An empty result would be a hole, not a level of detail.
    if (step.indices.empty()) break;
    const auto left = static_cast<double>(step.indices.size());
    if (left > kWorthTaking * static_cast<double>(coarse_.size())) break;
    limited = limited && step.indices.size() > target;
    std::vector<std::uint32_t> next = simplifier_->full_indices(step.indices);
    if (!origin_.empty()) {
      for (std::uint32_t& vertex : next) vertex = origin_[vertex];
    }
    const double estimate = estimate_ + step.error;
    const double error = surface_->distance_to(next, estimate, allowed, workers);
    if (error > allowed) continue;
    if (surface_->colored() && surface_->loses_colors(next, workers)) continue;
    simplifier_->take(std::move(step));
    coarse_ = std::move(next);
    estimate_ = estimate;
    error_ = error;
    level_.reset();
    return true;
  }
  if (limited) stuck_at_ = allowed;
  return false;
}

const Level& LodSurface::level(const Workers& workers) {
  if (!level_) {
    level_ = level_of(part_.vertices, coarse_);
    const bool whole = coarse_.size() == part_.indices.size();  // has its own normals
    if (!whole) restore_normals(*surface_, *level_, workers);
  }
  return *level_;
}

}  // namespace mirage
