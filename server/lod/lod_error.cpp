#include "server/lod/lod_error.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace mirage {
namespace {

// Constant for any number of threads, because a search begins where the one before ended.
constexpr std::size_t kChunks = 8;
constexpr std::size_t kAhead = 16;     // one of this many points is measured first
constexpr float kColorStep = 0.04f;    // in square roots of linear colour: ten of 255
constexpr double kWrongColors = 0.02;  // share of the vertices

// Selects every `step`-th of `count` things, in runs of neighbours.
struct Sampled {
  std::size_t step = 1, count = 0;

  Sampled(std::size_t things, std::size_t at_most)
      : step(std::max<std::size_t>(1, things / at_most)), count((things + step - 1) / step) {}
  std::size_t begin(std::size_t chunk) const { return count * chunk / kChunks; }
};

// Returns the largest distance from the sampled points to the tree, at least `floor`. It stops
// above `allowed`. Some points are measured first: the distance they find spares most searches of
// the others.
template <typename PointAt>
double largest_distance(const SurfaceTree& tree, const Sampled& sampled, const PointAt& point_at,
                        double floor, double allowed, double at_most, const Workers& workers) {
  for (const bool ahead : {true, false}) {
    std::array<double, kChunks> worst;
    workers.each(kChunks, [&](std::size_t chunk) {
      double found = floor;
      std::uint32_t near = 0;
      const std::size_t end = sampled.begin(chunk + 1);
      for (std::size_t k = sampled.begin(chunk); k < end && found <= allowed; ++k) {
        if ((k % kAhead == 0) != ahead) continue;
        found =
            std::max(found, tree.distance_above(found, point_at(k * sampled.step), at_most, near));
      }
      worst[chunk] = found;
    });
    floor = *std::max_element(worst.begin(), worst.end());
  }
  return floor;
}

}  // namespace

FullSurface::FullSurface(const std::vector<Vertex>& vertices,
                         const std::vector<std::uint32_t>& indices, double radius,
                         const DistanceSamples& samples, const Workers& workers)
    : vertices_(vertices),
      radius_(radius),
      samples_(samples),
      tree_(vertices, indices, workers),
      places_(tree_.places_of_vertices()),
      colored_(std::any_of(vertices.begin(), vertices.end(),
                           [&](const Vertex& v) { return v.color != vertices[0].color; })) {}

double FullSurface::distance_to(const std::vector<std::uint32_t>& coarse, double estimate,
                                double allowed, const Workers& workers) const {
  const SurfaceTree tree(vertices_, coarse, workers);
  const Sampled corners(vertices_.size(), samples_.vertices);
  const double floor = corners.step > 1 ? estimate : 0;
  const double there = largest_distance(
      tree, corners, [&](std::size_t i) { return vertices_[i].position; }, floor, allowed,
      4 * radius_, workers);
  if (there > allowed) return there;
  const auto middle = [&](std::size_t t) {
    return (vertices_[coarse[3 * t]].position + vertices_[coarse[3 * t + 1]].position +
            vertices_[coarse[3 * t + 2]].position) /
           3.0f;
  };
  return largest_distance(tree_, Sampled(coarse.size() / 3, samples_.triangles), middle, there,
                          allowed, 4 * radius_, workers);
}

bool FullSurface::loses_colors(const std::vector<std::uint32_t>& coarse,
                               const Workers& workers) const {
  const SurfaceTree tree(vertices_, coarse, workers);
  const Sampled sampled(vertices_.size(), samples_.vertices);
  std::array<std::size_t, kChunks> wrong{};
  workers.each(kChunks, [&](std::size_t chunk) {
    std::uint32_t near = 0;
    for (std::size_t k = sampled.begin(chunk); k < sampled.begin(chunk + 1); ++k) {
      const std::size_t i = k * sampled.step;
      const glm::vec4 right = glm::sqrt(glm::vec4(vertices_[i].color) / 65535.0f);
      const glm::vec4 shown = glm::sqrt(tree.shading_at(vertices_[i].position, near).color);
      const glm::vec4 d = glm::abs(right - shown);
      wrong[chunk] += std::max({d.x, d.y, d.z, d.w}) > kColorStep;
    }
  });
  const std::size_t sum = std::accumulate(wrong.begin(), wrong.end(), std::size_t{0});
  return static_cast<double>(sum) > kWrongColors * static_cast<double>(sampled.count);
}

}  // namespace mirage
