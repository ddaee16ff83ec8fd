#include "server/tile/tile_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/tile/tile_behind.h"

namespace mirage {
namespace {

struct Source {
  const std::uint8_t* rgba;
  const std::uint8_t* depth;
  int page_width;
  std::uint32_t edge;

  std::size_t at(std::uint32_t x, std::uint32_t y) const {  // y down
    return static_cast<std::size_t>(edge - 1 - y) * static_cast<std::size_t>(page_width) + x;
  }
  bool covered(std::uint32_t x, std::uint32_t y) const { return rgba[at(x, y) * 4 + 3] != 0; }
};

TileCrop content_crop(const Source& source) {
  std::uint32_t x0 = source.edge, y0 = source.edge, x1 = 0, y1 = 0;
  for (std::uint32_t y = 0; y < source.edge; ++y) {
    // The scan runs inwards from both ends and stops at the extent of earlier rows; texels between
    // are not read.
    std::uint32_t left = 0, right = source.edge;
    while (left < source.edge && !source.covered(left, y)) ++left;
    if (left == source.edge) continue;
    while (right > x1 && !source.covered(right - 1, y)) --right;
    x0 = std::min(x0, left);
    x1 = std::max(x1, right);
    y0 = std::min(y0, y);
    y1 = y + 1;
  }
  if (x0 >= x1) return {};
  x0 = x0 > 0 ? x0 - 1 : 0;
  y0 = y0 > 0 ? y0 - 1 : 0;
  x1 = std::min(x1 + 1, source.edge);
  y1 = std::min(y1 + 1, source.edge);
  return {x0, y0, x1 - x0, y1 - y0};
}

// Returns the largest dc^2 |1/z - 1/entry| over the content. The entry depth also takes the 3x3
// neighbourhood, which covers what happens between texel centres; in it, the nearest or the
// farthest entry differs most. Returns `unusable` if content lies where rays miss the proxy.
float entry_difference(const std::vector<float>& z, const std::vector<float>& entry,
                       const TileCrop& crop, float dc, float unusable) {
  constexpr float kNone = std::numeric_limits<float>::infinity();
  const std::size_t w = crop.w;
  // Per column over three rows; one more column on both sides.
  std::vector<float> low(w + 2, kNone), high(w + 2, 0.0f), worst(w, 0.0f), missed(w, 0.0f);
  for (std::uint32_t y = 0; y < crop.h; ++y) {
    std::fill(low.begin(), low.end(), kNone);
    std::fill(high.begin(), high.end(), 0.0f);
    for (std::uint32_t ny = y > 0 ? y - 1 : 0; ny <= std::min(y + 1, crop.h - 1); ++ny) {
      const float* const row = &entry[ny * w];
      for (std::size_t x = 0; x < w; ++x) {  // comparisons with NaN are false
        low[x + 1] = row[x] < low[x + 1] ? row[x] : low[x + 1];
        high[x + 1] = row[x] > high[x + 1] ? row[x] : high[x + 1];
      }
    }
    const float* const depths = &z[y * w];
    for (std::size_t x = 0; x < w; ++x) {
      const float depth = depths[x];
      const float near = std::min(std::min(low[x], low[x + 1]), low[x + 2]);
      const float far = std::max(std::max(high[x], high[x + 1]), high[x + 2]);
      const float scale = dc / depth;
      const float differs = std::max(std::abs(depth - near) * scale * (dc / near),
                                     std::abs(depth - far) * scale * (dc / far));
      const bool content = depth != 0, met = far > 0;
      worst[x] = content & met & (differs > worst[x]) ? differs : worst[x];
      missed[x] = content & !met ? 1.0f : missed[x];
    }
  }
  if (std::find(missed.begin(), missed.end(), 1.0f) != missed.end()) return unusable;
  return *std::max_element(worst.begin(), worst.end());
}

// Raises `gap` by the depth steps between `count` texels and those `ahead` of them.
void grow_gap(const float* z, std::size_t ahead, std::size_t count, std::vector<float>& gap) {
  for (std::size_t x = 0; x < count; ++x) {
    const float a = z[x], b = z[x + ahead], differs = std::abs(a - b);
    gap[x] = (a != 0) & (b != 0) & (differs > gap[x]) ? differs : gap[x];
  }
}

float largest_gap(const std::vector<float>& z, const TileCrop& crop) {
  std::vector<float> gap(crop.w, 0.0f);
  for (std::uint32_t y = 0; y < crop.h; ++y) {
    const float* const row = &z[std::size_t{y} * crop.w];
    grow_gap(row, 1, crop.w - 1, gap);
    if (y + 1 < crop.h) grow_gap(row, crop.w, crop.w, gap);
  }
  return *std::max_element(gap.begin(), gap.end());
}

/// Capture depth of each texel, 0: nothing there; and the least and greatest of these depths.
struct Depths {
  std::vector<float> z;
  float least = 0, greatest = 0;
};

Depths depths_of(const std::vector<std::uint8_t>& codes, const DepthCode& code) {
  std::array<float, 256> depth{};
  for (std::size_t i = 1; i < depth.size(); ++i) {
    depth[i] = static_cast<float>(code.decode(static_cast<std::uint8_t>(i)));
  }
  Depths out;
  out.z.resize(codes.size());
  // codes grow with depth; less 1, the code of nothing is 255
  std::uint8_t last = 0, before_first = 255;
  for (const std::uint8_t c : codes) {
    last = std::max(last, c);
    before_first = std::min(before_first, static_cast<std::uint8_t>(c - 1));
  }
  for (std::size_t i = 0; i < codes.size(); ++i) out.z[i] = depth[codes[i]];
  if (last > 0) {
    out.least = depth[before_first + std::size_t{1}];
    out.greatest = depth[last];
  }
  return out;
}

/// 1 / depth of a plane, which is linear in the texel.
struct Line {
  double at_corner, along_x, along_y;
  double at(double x, double y) const { return at_corner + along_y * y + along_x * x; }
};

constexpr std::uint32_t kBlock = 16;  // texels

struct Block {
  std::uint32_t x, y, w, h;  // position and size in the crop
};

// Picks the lines that no other line is below over the whole block, in their order.
void pick_least(const std::vector<Line>& lines, const Block& block, std::vector<Line>& picked) {
  const double across = block.w - 1, down = block.h - 1;
  double most = std::numeric_limits<double>::infinity();
  const auto middle = [&](const Line& line) {
    return line.at(block.x + 0.5 * across, block.y + 0.5 * down);
  };
  const auto swing = [&](const Line& line) {
    return 0.5 * (std::abs(line.along_x) * across + std::abs(line.along_y) * down);
  };
  for (const Line& line : lines) most = std::min(most, middle(line) + swing(line));
  picked.clear();
  for (const Line& line : lines) {
    // The margin exceeds rounding errors, and the comparison is false for NaN.
    const double least = middle(line) - swing(line);
    const bool above = least - 1e-12 * std::abs(least) > most + 1e-12 * std::abs(most);
    if (!above) picked.push_back(line);
  }
}

// Lowers `least` to the minimum of all lines at each texel of a row.
void take_least(const std::vector<Line>& lines, const Block& block, std::uint32_t y,
                std::array<double, kBlock>& least) {
  for (const Line& line : lines) {
    const double start = line.at_corner + line.along_y * y, left = block.x;
    for (int x = 0; x < static_cast<int>(kBlock); ++x) {  // the whole block is as cheap as a part
      const auto i = static_cast<std::size_t>(x);
      least[i] = std::min(least[i], start + line.along_x * (left + x));
    }
  }
}

/// `behind`: per texel the code of the farthest surface it shows; empty: nothing shows through.
void measure(Tile& tile, const std::vector<std::uint8_t>& behind, const Capture& capture,
             const ObjectDescription& object) {
  const DepthCode code(capture.radius, capture.distance);
  const auto quantum = static_cast<float>(code.quantum());
  const Depths depths = depths_of(tile.depth, code);
  if (depths.greatest == 0) return;
  const std::vector<float>& z = depths.z;
  const Depths farthest = behind.empty() ? Depths{} : depths_of(behind, code);
  TileMeasure& m = tile.measure;
  m.depth_min = std::max(depths.least - quantum, 0.0f);
  m.depth_max = std::max(depths.greatest, farthest.greatest) + quantum;
  // The harmonic mean balances |z - plane| / (z * plane) between the near and the far end.
  m.plane_depth = 2.0f * m.depth_min * m.depth_max / (m.depth_min + m.depth_max);
  const auto dc = static_cast<float>(capture.distance);
  m.dz_quad = 0.5f * dc * dc * (m.depth_max - m.depth_min) / (m.depth_min * m.depth_max) * 1.00001f;
  m.depth_gap = largest_gap(z, tile.crop);
  for (std::size_t i = 0; i < farthest.z.size(); ++i) {
    if (z[i] == 0 || tile.layered()) continue;  // a layer behind has its own depth
    const float off = dc / z[i] - dc / farthest.z[i];
    m.dz_behind = std::max(m.dz_behind, off * dc * 1.00001f);
  }
  const glm::dvec3 center(object.center);
  const auto box =
      entry_depths(box_planes(object.box_min, object.box_max), capture, center, tile.crop);
  // Half a step of the depth code, which is linear in 1 / z.
  const auto step =
      static_cast<float>(code.inverse_quantum() * capture.distance * capture.distance);
  const auto unusable = static_cast<float>(100.0 * capture.distance);
  // The surfaces behind blended ones count as well.
  const auto off_proxy = [&](const std::vector<float>& entry) {
    float off = entry_difference(z, entry, tile.crop, dc, unusable);
    if (!farthest.z.empty()) {
      off = std::max(off, entry_difference(farthest.z, entry, tile.crop, dc, unusable));
    }
    return off + step;
  };
  m.dz_cuboid = off_proxy(box);
  const std::vector<Plane> hull = object.hull.planes();
  if (hull.empty()) {
    m.dz_hull = m.dz_cuboid;
  } else {
    m.dz_hull = off_proxy(entry_depths(hull, capture, center, tile.crop));
  }
}

// Returns the code of the farthest surface that each texel of the crop shows; empty if that is the
// texel's own depth everywhere.
std::vector<std::uint8_t> codes_behind(const PageTexels& page, const Source& source,
                                       const Tile& tile, const ObjectDescription& object) {
  if (tile.layered()) {
    std::vector<std::uint8_t> out = tile.depth;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::max(out[i], tile.behind_depth[i]);
    return out;
  }
  if (tile.channels != kLitTile || !page.surface || !(object.needs & kNeedBlend)) return {};
  std::vector<std::uint8_t> out(tile.depth.size());
  bool any = false;
  for (std::uint32_t y = 0; y < tile.crop.h; ++y) {
    for (std::uint32_t x = 0; x < tile.crop.w; ++x) {
      const std::size_t i = std::size_t{y} * tile.crop.w + x;
      const int behind = page.surface[source.at(tile.crop.x + x, tile.crop.y + y) * 4];
      if (tile.depth[i] == 0) continue;
      out[i] = static_cast<std::uint8_t>(std::min(tile.depth[i] + behind, 255));
      any = any || behind > 0;
    }
  }
  if (!any) out.clear();
  return out;
}

}  // namespace

std::vector<float> entry_depths(const std::vector<Plane>& planes, const Capture& capture,
                                const glm::dvec3& center, const TileCrop& crop) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // The ray's direction has length 1 along the axis, so its parameter is the capture depth. 1 /
  // depth of a plane is linear in the texel.
  const glm::dvec3 eye = capture.eye();
  const glm::dvec2 first(crop.x + 0.5, crop.y + 0.5);
  const glm::dvec3 corner = capture.point_from_texel(first, 1.0);
  const glm::dvec3 along_x = capture.point_from_texel(first + glm::dvec2(1, 0), 1.0) - corner;
  const glm::dvec3 along_y = capture.point_from_texel(first + glm::dvec2(0, 1), 1.0) - corner;
  std::vector<Line> entering, leaving;  // `leaving` is negated: its greatest value counts
  for (const Plane& plane : planes) {
    const glm::dvec3 n(plane.normal);
    double gap = plane.offset - glm::dot(n, center + eye);
    if (gap == 0) gap = std::numeric_limits<double>::min();
    if (gap < 0) {
      entering.push_back({glm::dot(n, corner - eye) / gap, glm::dot(n, along_x) / gap,
                          glm::dot(n, along_y) / gap});
    } else {
      leaving.push_back({-glm::dot(n, corner - eye) / gap, -glm::dot(n, along_x) / gap,
                         -glm::dot(n, along_y) / gap});
    }
  }
  constexpr float kMissed = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> out(crop.area());
  std::vector<Line> first_in, first_out;
  std::array<double, kBlock> enter{}, leave{};
  for (std::uint32_t top = 0; top < crop.h; top += kBlock) {
    for (std::uint32_t left = 0; left < crop.w; left += kBlock) {
      const Block block{left, top, std::min(kBlock, crop.w - left), std::min(kBlock, crop.h - top)};
      pick_least(entering, block, first_in);
      pick_least(leaving, block, first_out);
      for (std::uint32_t y = top; y < top + block.h; ++y) {
        enter.fill(kInfinity);
        leave.fill(0.0);
        take_least(first_in, block, y, enter);
        take_least(first_out, block, y, leave);
        float* const row = &out[std::size_t{y} * crop.w + left];
        for (std::uint32_t x = 0; x < block.w; ++x) {
          const bool met = (enter[x] > 0) & (enter[x] >= -leave[x]);
          row[x] = met ? static_cast<float>(1 / enter[x]) : kMissed;
        }
      }
    }
  }
  return out;
}

Tile cut_tile(const PageTexels& page, std::uint8_t channels, const Capture& capture,
              const ObjectDescription& object) {
  const Source source{page.rgba, page.depth, page.width, capture.edge};
  Tile tile;
  tile.edge = capture.edge;
  tile.channels = channels;
  tile.crop = content_crop(source);
  const auto copy = [&](const std::uint8_t* from, std::size_t bytes,
                        std::vector<std::uint8_t>& to) {
    to.resize(tile.crop.area() * bytes);
    const std::size_t row = std::size_t{tile.crop.w} * bytes;
    for (std::uint32_t y = 0; y < tile.crop.h; ++y) {
      std::copy_n(from + source.at(tile.crop.x, tile.crop.y + y) * bytes, row,
                  to.begin() + static_cast<std::ptrdiff_t>(y * row));
    }
  };
  if (channels & kChannelColor) copy(page.rgba, 4, tile.rgba);
  if (channels & kChannelNormal) copy(page.surface, 4, tile.surface);
  if (channels & kChannelDepth) copy(page.depth, 1, tile.depth);
  if (channels & kChannelShadow) copy(page.depth, 1, tile.shadow);
  if (channels & kChannelBehind) {
    std::vector<std::uint8_t> packed;
    copy(page.surface, 4, packed);
    unpack_behind(packed, tile);
    drop_poor_layer(tile);
  }
  if (is_picture(channels))
    measure(tile, codes_behind(page, source, tile, object), capture, object);
  return tile;
}

}  // namespace mirage
