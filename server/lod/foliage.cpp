#include "server/lod/foliage.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mirage {
namespace {

constexpr std::size_t kFoliagePieces = 8;    // fewer pieces are visible one by one
constexpr std::size_t kPieceTriangles = 64;  // pieces with a larger mean are surfaces
constexpr std::size_t kSampledPieces = 2'000;
// An enlarged piece stays hidden among others unless it grows by this many times the way to the
// next.
constexpr float kSeenGrowth = 3;
constexpr float kSlender = 3;  // a piece as long as this many widths, or longer, is a blade
// A broadened blade is seen as one of its own as soon as its width, times this, is seen to move.
constexpr float kSeenWidth = 1;
constexpr float kFlat = 0.5f;  // share of the width up to which a piece's thickness is flat

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

template <typename Use>
void each_corner(const Part& part, const Piece& piece, const Use& use) {
  for (const std::uint32_t t : piece.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      use(part.vertices[part.indices[3 * std::size_t{t} + k]].position);
    }
  }
}

// Returns the offset from `from` to the corner that is farthest from it, after `part_of` each.
template <typename PartOf>
glm::vec3 farthest(const Part& part, const Piece& piece, const PartOf& part_of) {
  glm::vec3 out(0);
  each_corner(part, piece, [&](const glm::vec3& corner) {
    const glm::vec3 offset = part_of(corner);
    if (glm::dot(offset, offset) > glm::dot(out, out)) out = offset;
  });
  return out;
}

glm::vec3 direction_or(const glm::vec3& v, const glm::vec3& other) {
  const float length = glm::length(v);
  return length > 1e-20f ? v / length : other;
}

// Sets the middle, and the frame: along from one end to the farthest corner, across to the corner
// farthest from that line.
void place(const Part& part, Piece& piece) {
  glm::dvec3 sum(0);
  each_corner(part, piece, [&](const glm::vec3& corner) { sum += glm::dvec3(corner); });
  piece.middle = glm::vec3(sum / (3.0 * static_cast<double>(piece.triangles.size())));
  const auto from = [](const glm::vec3& origin) {
    return [origin](const glm::vec3& corner) { return corner - origin; };
  };
  const glm::vec3 end = piece.middle + farthest(part, piece, from(piece.middle));
  const glm::vec3 along = direction_or(farthest(part, piece, from(end)), glm::vec3(1, 0, 0));
  const glm::vec3 aside = std::abs(along.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  const glm::vec3 across = direction_or(farthest(part, piece,
                                                 [&](const glm::vec3& corner) {
                                                   const glm::vec3 offset = corner - end;
                                                   return offset - glm::dot(offset, along) * along;
                                                 }),
                                        glm::normalize(glm::cross(along, aside)));
  piece.axes = glm::mat3(along, across, glm::cross(along, across));
  each_corner(part, piece, [&](const glm::vec3& corner) {
    piece.half = glm::max(piece.half, glm::abs((corner - piece.middle) * piece.axes));
  });
}

// Returns the factors along a piece's axes that make it cover `growth` times its area.
glm::vec3 enlargement(const Piece& piece, double growth) {
  const auto uniform = static_cast<float>(std::sqrt(growth));
  if (piece.half.z > kFlat * piece.half.y) return glm::vec3(uniform);
  const float slender = piece.half.y > 0 ? piece.half.x / piece.half.y : 1.0f;
  const float wider = std::clamp(static_cast<float>(growth), 1.0f, std::max(slender, 1.0f));
  const auto rest = static_cast<float>(std::sqrt(growth / double{wider}));
  return {rest, rest * wider, 1};
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

/// Returns the value that 95 % of the pieces do not exceed.
template <typename ValueOf>
float most_of(const std::vector<Piece>& pieces, const ValueOf& value_of) {
  std::vector<float> values;
  for (const Piece& piece : pieces) values.push_back(value_of(piece));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 95 / 100);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Returns the distance within which most pieces end that grow by `growth`, from where they ended
/// before.
float growth_of(const std::vector<Piece>& pieces, double growth) {
  return most_of(pieces, [&](const Piece& piece) {
    return glm::length((enlargement(piece, growth) - 1.0f) * piece.half);
  });
}

/// Returns the width of most slender pieces that grow by `growth`.
float width_of(const std::vector<Piece>& pieces, double growth) {
  return most_of(pieces, [&](const Piece& piece) {
    if (piece.half.x < kSlender * piece.half.y) return 0.0f;
    return 2 * piece.half.y * enlargement(piece, growth).y;
  });
}

}  // namespace

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
  for (Piece& piece : pieces) place(part, piece);
  rank_by_hash(pieces);
  return pieces;
}

bool is_foliage(const Part& part, const std::vector<Piece>& pieces) {
  return pieces.size() >= kFoliagePieces && part.triangles() <= pieces.size() * kPieceTriangles;
}

Thinned thinned(const Part& part, const std::vector<Piece>& pieces, double share) {
  const auto kept = static_cast<double>(std::count_if(
      pieces.begin(), pieces.end(), [&](const Piece& piece) { return piece.rank < share; }));
  const double growth = static_cast<double>(pieces.size()) / kept;
  Thinned out;
  out.vertices = part.vertices;
  std::vector<bool> moved(out.vertices.size(), false);
  for (const Piece& piece : pieces) {
    if (!(piece.rank < share)) continue;
    const glm::vec3 larger = enlargement(piece, growth);
    for (const std::uint32_t t : piece.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = part.indices[3 * std::size_t{t} + k];
        out.indices.push_back(v);
        if (moved[v]) continue;
        moved[v] = true;
        glm::vec3& at = out.vertices[v].position;
        at = piece.middle + piece.axes * (larger * ((at - piece.middle) * piece.axes));
      }
    }
  }
  const float spread = spread_of(pieces, share), grown = growth_of(pieces, growth);
  out.spread = grown > kSeenGrowth * spread ? grown : spread;
  out.spread = std::max(out.spread, kSeenWidth * width_of(pieces, growth));
  return out;
}

}  // namespace mirage
