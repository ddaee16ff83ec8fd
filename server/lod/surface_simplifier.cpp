#include "server/lod/surface_simplifier.h"

#include <meshoptimizer.h>

#include <numeric>
#include <utility>

namespace mirage {

SurfaceSimplifier::SurfaceSimplifier(const std::vector<Vertex>& vertices,
                                     std::vector<std::uint32_t> indices, bool lock_border)
    : indices_(std::move(indices)),
      full_(vertices.size()),
      place_(vertices.size()),
      span_{},
      options_(lock_border ? unsigned{meshopt_SimplifyLockBorder} : 0u) {
  positions_.reserve(vertices.size());
  for (const Vertex& v : vertices) positions_.push_back(v.position);
  std::iota(full_.begin(), full_.end(), 0u);
  if (positions_.empty()) return;
  scale_ = double{meshopt_simplifyScale(&positions_[0].x, positions_.size(), sizeof(glm::vec3))};
  places_ = meshopt_generateVertexRemap(place_.data(), nullptr, positions_.size(),
                                        positions_.data(), positions_.size(), sizeof(glm::vec3));
  std::array<std::size_t, 6> far{};
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto axis = static_cast<int>(c);
      const float at = positions_[i][axis];
      if (at < positions_[far[c]][axis]) far[c] = i;
      if (at > positions_[far[3 + c]][axis]) far[3 + c] = i;
    }
  }
  for (std::size_t k = 0; k < far.size(); ++k) span_[k] = place_[far[k]];
}

SurfaceSimplifier::Step SurfaceSimplifier::simplified(std::size_t target, double error) const {
  Step out;
  out.indices.resize(indices_.size());
  float relative = 0;
  out.indices.resize(meshopt_simplify(
      out.indices.data(), indices_.data(), indices_.size(), &positions_[0].x, positions_.size(),
      sizeof(glm::vec3), target, static_cast<float>(error / scale_), options_, &relative));
  out.error = double{relative} * scale_;
  return out;
}

void SurfaceSimplifier::take(Step step) {
  std::vector<bool> stays(places_, false);
  for (const std::uint32_t i : step.indices) stays[place_[i]] = true;
  for (const std::uint32_t place : span_) stays[place] = true;
  std::vector<std::uint32_t> now(positions_.size());
  std::uint32_t left = 0;  // keeps their order: among equally good choices, the first counts
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (!stays[place_[i]]) continue;
    positions_[left] = positions_[i];
    full_[left] = full_[i];
    place_[left] = place_[i];
    now[i] = left++;
  }
  positions_.resize(left);
  full_.resize(left);
  place_.resize(left);
  indices_ = std::move(step.indices);
  for (std::uint32_t& i : indices_) i = now[i];
}

std::vector<std::uint32_t> SurfaceSimplifier::full_indices(
    const std::vector<std::uint32_t>& indices) const {
  std::vector<std::uint32_t> out;
  out.reserve(indices.size());
  for (const std::uint32_t i : indices) out.push_back(full_[i]);
  return out;
}

}  // namespace mirage
