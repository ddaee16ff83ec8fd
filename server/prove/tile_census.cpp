#include "server/prove/tile_census.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>

#include "protocol/codec/tile_codec.h"
#include "server/render/tile_shot.h"
#include "server/scene/scene.h"
#include "server/tile/tile_job.h"
#include "server/tile/tile_measure.h"

namespace mirage {
namespace {

std::size_t coded(const Tile& tile) { return encode_tile_planes(tile, TileCodec::kZstd).size(); }

// True if every edge borders two triangles, once in each direction.
bool is_closed(const Mesh& mesh) {
  const auto less = [](const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::map<glm::vec3, std::uint32_t, decltype(less)> corners(less);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Primitive& p : mesh.primitives) {
    if (p.kind != PrimitiveKind::kTriangles) return false;
    for (std::uint32_t i = 0; i + 2 < p.index_count; i += 3) {
      std::uint32_t corner[3];
      for (std::uint32_t k = 0; k < 3; ++k) {
        const glm::vec3& at = mesh.vertices[mesh.indices[p.first_index + i + k]].position;
        corner[k] = corners.emplace(at, static_cast<std::uint32_t>(corners.size())).first->second;
      }
      for (int k = 0; k < 3; ++k) {
        if (corner[k] != corner[(k + 1) % 3]) ++edges[{corner[k], corner[(k + 1) % 3]}];
      }
    }
  }
  return !edges.empty() && std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    const auto back = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && back != edges.end() && back->second == 1;
  });
}

// Counts the texels of the box that lie outside the octagon of the content's extents along the
// diagonals.
std::size_t outside_octagon(const Tile& tile) {
  const auto w = static_cast<int>(tile.crop.w), h = static_cast<int>(tile.crop.h);
  constexpr int kFar = std::numeric_limits<int>::max();
  int sum_low = kFar, sum_high = -kFar, difference_low = kFar, difference_high = -kFar;
  for (int i = 0; i < w * h; ++i) {
    if (tile.rgba[static_cast<std::size_t>(i) * 4 + 3] == 0) continue;
    const int x = i % w, y = i / w;
    sum_low = std::min(sum_low, x + y);
    sum_high = std::max(sum_high, x + y);
    difference_low = std::min(difference_low, x - y);
    difference_high = std::max(difference_high, x - y);
  }
  std::size_t out = 0;
  for (int i = 0; i < w * h; ++i) {
    const int x = i % w, y = i / w;
    out += x + y < sum_low || x + y > sum_high || x - y < difference_low || x - y > difference_high;
  }
  return out;
}

// Counts the texels whose eight neighbours are equal: one sample would do.
std::size_t flat_texels(const Tile& tile) {
  const std::size_t w = tile.crop.w, h = tile.crop.h;
  std::size_t out = 0;
  for (std::size_t y = 1; y + 1 < h; ++y) {
    for (std::size_t x = 1; x + 1 < w; ++x) {
      const std::uint8_t* at = &tile.rgba[(y * w + x) * 4];
      bool same = at[3] == 255;
      for (std::size_t n = 0; n < 9 && same; ++n) {
        same = std::equal(at, at + 4, &tile.rgba[((y + n / 3 - 1) * w + x + n % 3 - 1) * 4]);
      }
      out += same;
    }
  }
  return out;
}

struct Colors {
  bool gray = true, solid = true, opaque = true, two_alphas = true;
};

Colors colors_of(const Tile& tile) {
  Colors out;
  const std::uint8_t* first = nullptr;
  for (std::size_t i = 0; i < tile.rgba.size(); i += 4) {
    const std::uint8_t* p = &tile.rgba[i];
    out.opaque = out.opaque && p[3] == 255;
    out.two_alphas = out.two_alphas && (p[3] == 0 || p[3] == 255);
    if (p[3] == 0) continue;
    if (!first) first = p;
    out.gray = out.gray && p[0] == p[1] && p[1] == p[2];
    out.solid = out.solid && std::equal(p, p + 3, first);
  }
  return out;
}

}  // namespace

void TileCensus::add(const TileShot& shot, const TileJob& job, const ObjectDescription& object,
                     const TileCost& cost) {
  const std::uint32_t cell = std::uint32_t{job.key.cell.x} << 16 | job.key.cell.y;
  if (!keys_.emplace(job.key.object, cell, job.key.size_class, job.lighting.hash()).second) return;
  const Capture capture(job.key.cell, job.key.distance, object.radius, shot.edge);
  const PageTexels page{shot.color.data(), shot.code.data(), nullptr, static_cast<int>(shot.edge)};
  Tile tile = cut_tile(page, kLitTile, capture, object);
  if (tile.crop.area() == 0) return;
  ++tiles_;
  bytes_ += static_cast<double>(cost.bytes);
  draw_ms_ += shot.ms;
  encode_ms_ += cost.ms;
  const Colors colors = colors_of(tile);
  opaque_ += colors.opaque;
  two_alphas_ += colors.two_alphas;
  gray_ += colors.gray;
  solid_ += colors.solid;
  twins_ += !pictures_.emplace(job.key.object, tile_content_hash(tile)).second;
  texels_ += tile.crop.area();
  outside_octagon_ += outside_octagon(tile);
  flat_ += flat_texels(tile);
  Tile no_depth = tile;
  no_depth.channels = kChannelColor;
  depth_bytes_ += static_cast<double>(cost.bytes) - static_cast<double>(coded(no_depth));
  for (std::size_t i = 3; i < tile.rgba.size(); i += 4) tile.rgba[i] = 255;
  const double saved = static_cast<double>(cost.bytes) - static_cast<double>(coded(tile));
  // An uncompressed mask takes at least one bit a texel.
  if (colors.two_alphas) mask_bytes_ += saved - static_cast<double>(tile.crop.area()) / 8;
  if (colors.opaque) alpha_bytes_ += saved;
}

void TileCensus::add_object(const SceneObject& object, const std::vector<Material>& materials) {
  ++objects_;
  const auto& parts = object.mesh.primitives;
  const bool opaque = std::all_of(parts.begin(), parts.end(), [&](const Primitive& p) {
    return materials[p.material].alpha_mode == AlphaMode::kOpaque;
  });
  const bool double_sided = std::any_of(parts.begin(), parts.end(), [&](const Primitive& p) {
    return materials[p.material].double_sided;
  });
  double_sided_solids_ += opaque && double_sided && is_closed(object.mesh);
}

std::vector<DroppedFigure> TileCensus::figures() const {
  const auto n = static_cast<double>(std::max<std::size_t>(tiles_, 1));
  const auto percent = [](double part, double of) { return of > 0 ? 100 * part / of : 0; };
  const auto texels = static_cast<double>(texels_);
  return {
      {NeedRule::kMaskBits, fmt::format("{} of {} tiles have only two alphas", two_alphas_, tiles_),
       mask_bytes_ / n},
      {NeedRule::kAlpha, fmt::format("{} of {} tiles are opaque everywhere", opaque_, tiles_),
       alpha_bytes_ / n},
      {NeedRule::kDepth, fmt::format("depth is {:.0f} % of a tile", percent(depth_bytes_, bytes_)),
       depth_bytes_ / n},
      {NeedRule::kSolidColor,
       fmt::format("{} of {} tiles have one colour, {} are gray", solid_, tiles_, gray_), 0},
      {NeedRule::kCrop,
       fmt::format("an octagon would leave out {:.1f} % more texels, which compress to nothing",
                   percent(static_cast<double>(outside_octagon_), texels)),
       0},
      {NeedRule::kSymmetry,
       fmt::format("{} of {} tiles equal another of their object", twins_, tiles_), 0},
      {NeedRule::kBackFaces,
       fmt::format("{} of {} objects are closed, opaque and double-sided", double_sided_solids_,
                   objects_),
       0},
      {NeedRule::kCodec,
       fmt::format("encoding takes {:.1f} % of a tile's time",
                   percent(encode_ms_, draw_ms_ + encode_ms_)),
       0},
      {NeedRule::kAntiAliasing,
       fmt::format("{:.1f} % of texels are flat", percent(static_cast<double>(flat_), texels)), 0},
  };
}

}  // namespace mirage
