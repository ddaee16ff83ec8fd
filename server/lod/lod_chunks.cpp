#include "server/lod/lod_chunks.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace mirage {
namespace {

constexpr DistanceSamples kChunkSamples{1'000, 500};

struct Center {
  glm::vec3 at;
  std::uint32_t triangle;
};

/// A range of Centers.
struct Run {
  std::size_t first, count;
};

// Halves `run` across its longest side, and each half again, down to `most` triangles.
void cut(Center* centers, std::size_t count, std::size_t most, const Workers& workers) {
  if (count <= most) return;
  glm::vec3 low = centers->at, high = low;
  for (const Center* center = centers; center != centers + count; ++center) {
    low = glm::min(low, center->at);
    high = glm::max(high, center->at);
  }
  const glm::vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t half = count / 2;
  std::nth_element(
      centers, centers + half, centers + count, [axis](const Center& a, const Center& b) {
        return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.triangle < b.triangle;
      });
  workers.both([&] { cut(centers, half, most, workers); },
               [&] { cut(centers + half, count - half, most, workers); });
}

// Adds the ranges that cut() makes.
void add_runs(const Run& whole, std::size_t most, std::vector<Run>& out) {
  if (whole.count <= most) return out.push_back(whole);
  const std::size_t half = whole.count / 2;
  add_runs({whole.first, half}, most, out);
  add_runs({whole.first + half, whole.count - half}, most, out);
}

std::vector<Center> centers_of(const Part& part, const Workers& workers) {
  constexpr std::size_t kPieces = 16;
  std::vector<Center> out(part.triangles());
  workers.each(kPieces, [&](std::size_t piece) {
    const std::size_t end = out.size() * (piece + 1) / kPieces;
    for (std::size_t t = out.size() * piece / kPieces; t < end; ++t) {
      const std::uint32_t* at = &part.indices[3 * t];
      const std::vector<Vertex>& v = part.vertices;
      out[t] = {(v[at[0]].position + v[at[1]].position + v[at[2]].position) / 3.0f,
                static_cast<std::uint32_t>(t)};
    }
  });
  return out;
}

/// One chunk on its own vertices.
struct Chunk {
  Part part;
  std::vector<std::uint32_t> whole;  ///< by vertex: its index in the whole part
};

Chunk chunk_of(const Part& part, std::vector<std::uint32_t> triangles) {
  std::sort(triangles.begin(), triangles.end());  // keeps neighbours together in memory
  Chunk out;
  out.part.material = part.material;
  out.part.indices.reserve(3 * triangles.size());
  std::unordered_map<std::uint32_t, std::uint32_t> place;
  place.reserve(triangles.size());
  for (const std::uint32_t t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = part.indices[3 * std::size_t{t} + k];
      const auto [at, is_new] =
          place.emplace(vertex, static_cast<std::uint32_t>(out.part.vertices.size()));
      if (is_new) {
        out.part.vertices.push_back(part.vertices[vertex]);
        out.whole.push_back(vertex);
      }
      out.part.indices.push_back(at->second);
    }
  }
  return out;
}

/// The result of simplifying a chunk.
struct Simplified {
  std::vector<std::uint32_t> indices;  ///< into the vertices of the whole part
  /// the same triangles; from kCopies on, indices into `copies`
  std::vector<std::uint32_t> shown;
  std::vector<Vertex> copies;
  double error = 0;
};
constexpr std::uint32_t kCopies = 1u << 31;

// Simplifies the triangles `inner` of a chunk and keeps its rim unchanged. If both sides of a
// border were simplified up to it, each side could bridge the same corners, and an edge shared by
// four triangles would stay for ever.
Simplified simplified(const Part& part, const std::vector<std::uint32_t>& rim,
                      std::vector<std::uint32_t> inner, double share, double allowed, bool soup) {
  Simplified out;
  for (const std::uint32_t t : rim) {
    const auto at = part.indices.begin() + 3 * std::ptrdiff_t{t};
    out.indices.insert(out.indices.end(), at, at + 3);
  }
  out.shown = out.indices;
  if (inner.empty()) return out;
  const double wanted = share * static_cast<double>(rim.size() + inner.size());
  const auto target =
      static_cast<std::size_t>(std::max(std::ceil(wanted) - static_cast<double>(rim.size()), 1.0));
  const Chunk chunk = chunk_of(part, std::move(inner));
  const Workers alone;
  LodSurface surface(chunk.part, {soup, true, kChunkSamples}, alone);
  surface.reduce(target, allowed, alone);
  out.error = surface.error();
  for (const std::uint32_t i : surface.indices()) out.indices.push_back(chunk.whole[i]);
  const Level& level = surface.level(alone);
  const std::size_t own = level.vertices.size() - level.copies;
  for (const std::uint32_t i : level.indices) {
    out.shown.push_back(i < own ? chunk.whole[level.origin[i]]
                                : kCopies + static_cast<std::uint32_t>(i - own));
  }
  out.copies.assign(level.vertices.begin() + static_cast<std::ptrdiff_t>(own),
                    level.vertices.end());
  return out;
}

/// Finds the vertices at which chunks meet.
class Borders {
 public:
  explicit Borders(const Part& part) : place_(part.vertices.size()) {
    places_ =
        meshopt_generateVertexRemap(place_.data(), nullptr, place_.size(),
                                    positions_of(part).data(), place_.size(), sizeof(glm::vec3));
  }

  void find(const Part& part, const std::vector<Center>& centers, const std::vector<Run>& runs) {
    shared_.assign(places_, false);
    std::vector<std::uint32_t> owner(places_, UINT32_MAX);
    for (std::uint32_t run = 0; run < runs.size(); ++run) {
      for (std::size_t k = 0; k < 3 * runs[run].count; ++k) {
        const std::size_t t = centers[runs[run].first + k / 3].triangle;
        const std::uint32_t place = place_[part.indices[3 * t + k % 3]];
        if (owner[place] == UINT32_MAX) owner[place] = run;
        if (owner[place] != run) shared_[place] = true;
      }
    }
  }

  bool touches(const Part& part, std::uint32_t triangle) const {
    const std::uint32_t* at = &part.indices[3 * std::size_t{triangle}];
    return std::any_of(at, at + 3, [&](std::uint32_t v) { return shared_[place_[v]]; });
  }

 private:
  static std::vector<glm::vec3> positions_of(const Part& part) {
    std::vector<glm::vec3> out;
    out.reserve(part.vertices.size());
    for (const Vertex& v : part.vertices) out.push_back(v.position);
    return out;
  }

  std::vector<std::uint32_t> place_;  ///< by vertex: number of its position
  std::size_t places_ = 0;
  std::vector<bool> shared_;  ///< by position
};

}  // namespace

ChunkedStep simplify_in_chunks(const Part& part, std::size_t triangles, double allowed, bool soup,
                               const Workers& workers, std::size_t chunk_triangles) {
  std::vector<Center> centers = centers_of(part, workers);
  std::vector<Run> runs;
  add_runs({0, centers.size()}, chunk_triangles, runs);
  std::optional<Borders> borders;
  workers.both([&] { cut(centers.data(), centers.size(), chunk_triangles, workers); },
               [&] { borders.emplace(part); });
  borders->find(part, centers, runs);
  const double share = static_cast<double>(triangles) / static_cast<double>(part.triangles());
  std::vector<Simplified> chunks(runs.size());
  workers.each(runs.size(), [&](std::size_t i) {
    std::vector<std::uint32_t> rim, inner;
    for (std::size_t k = 0; k < runs[i].count; ++k) {
      const std::uint32_t t = centers[runs[i].first + k].triangle;
      (borders->touches(part, t) ? rim : inner).push_back(t);
    }
    chunks[i] = simplified(part, rim, std::move(inner), share, allowed, soup);
  });
  centers = {};
  borders.reset();

  ChunkedStep out;
  out.part.material = out.shown.material = part.material;
  std::vector<std::uint32_t> place(part.vertices.size(), UINT32_MAX);
  for (const Simplified& chunk : chunks) {
    for (const std::uint32_t vertex : chunk.indices) {
      if (place[vertex] == UINT32_MAX) {
        place[vertex] = static_cast<std::uint32_t>(out.part.vertices.size());
        out.part.vertices.push_back(part.vertices[vertex]);
      }
      out.part.indices.push_back(place[vertex]);
    }
    out.error = std::max(out.error, chunk.error);
  }
  out.shown.vertices = out.part.vertices;
  for (const Simplified& chunk : chunks) {
    const auto first = static_cast<std::uint32_t>(out.shown.vertices.size());
    for (const std::uint32_t i : chunk.shown) {
      out.shown.indices.push_back(i < kCopies ? place[i] : first + (i - kCopies));
    }
    out.shown.vertices.insert(out.shown.vertices.end(), chunk.copies.begin(), chunk.copies.end());
  }
  return out;
}

}  // namespace mirage
