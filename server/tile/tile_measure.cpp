#include "server/tile/tile_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "server/tile/proxy_entry.h"
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

// Sets in `all` the bits that a row has.
void unite(const std::uint8_t* row, std::size_t bytes, std::uint8_t* all) {
  for (std::size_t i = 0; i < bytes; ++i) all[i] = static_cast<std::uint8_t>(all[i] | row[i]);
}

TileCrop content_crop(const Source& source) {
  const std::size_t row_bytes = std::size_t{source.edge} * 4;
  std::vector<std::uint8_t> columns(row_bytes);
  for (std::uint32_t y = 0; y < source.edge; ++y) {
    unite(source.rgba + source.at(0, y) * 4, row_bytes, columns.data());
  }
  std::uint32_t x0 = 0, x1 = source.edge, y0 = 0, y1 = source.edge;
  while (x0 < x1 && columns[x0 * 4 + 3] == 0) ++x0;
  if (x0 == x1) return {};
  while (columns[x1 * 4 - 1] == 0) --x1;
  const auto empty = [&](std::uint32_t y) {
    std::uint32_t x = x0;
    while (x < x1 && !source.covered(x, y)) ++x;
    return x == x1;
  };
  while (empty(y0)) ++y0;
  while (empty(y1 - 1)) --y1;
  x0 = x0 > 0 ? x0 - 1 : 0;
  y0 = y0 > 0 ? y0 - 1 : 0;
  x1 = std::min(x1 + 1, source.edge);
  y1 = std::min(y1 + 1, source.edge);
  return {x0, y0, x1 - x0, y1 - y0};
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

/// Returns the capture depth of each texel, 0: nothing there.
std::vector<float> depths_of(const std::vector<std::uint8_t>& codes, const CodedDepths& coded) {
  std::vector<float> out(codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) out[i] = coded.depths[codes[i]];
  return out;
}

/// `behind`: per texel the code of the farthest surface it shows; empty: nothing shows through.
void measure(Tile& tile, const std::vector<std::uint8_t>& behind, const Capture& capture,
             const ObjectDescription& object) {
  const DepthCode code(capture.radius, capture.distance);
  const auto quantum = static_cast<float>(code.quantum());
  const CodedDepths nearest(tile.depth, tile.crop, code);
  if (nearest.all.last == 0) return;
  std::optional<CodedDepths> farthest;
  if (!behind.empty()) farthest.emplace(behind, tile.crop, code);
  TileMeasure& m = tile.measure;
  m.depth_min = std::max(nearest.depths[nearest.all.first] - quantum, 0.0f);
  m.depth_max =
      nearest.depths[std::max<int>(nearest.all.last, farthest ? farthest->all.last : 0)] + quantum;
  // The harmonic mean balances |z - plane| / (z * plane) between the near and the far end.
  m.plane_depth = 2.0f * m.depth_min * m.depth_max / (m.depth_min + m.depth_max);
  const auto dc = static_cast<float>(capture.distance);
  m.dz_quad = 0.5f * dc * dc * (m.depth_max - m.depth_min) / (m.depth_min * m.depth_max) * 1.00001f;
  m.depth_gap = largest_gap(depths_of(tile.depth, nearest), tile.crop);
  for (std::size_t i = 0; i < behind.size(); ++i) {
    if (tile.depth[i] == 0 || tile.layered()) continue;  // a layer behind has its own depth
    const float off = dc / nearest.depths[tile.depth[i]] - dc / nearest.depths[behind[i]];
    m.dz_behind = std::max(m.dz_behind, off * dc * 1.00001f);
  }
  const glm::dvec3 center(object.center);
  // Half a step of the depth code, which is linear in 1 / z.
  const auto step =
      static_cast<float>(code.inverse_quantum() * capture.distance * capture.distance);
  const auto unusable = static_cast<float>(100.0 * capture.distance);
  // The surfaces behind blended ones count as well.
  const auto off_proxy = [&](const std::vector<Plane>& planes) {
    const ProxyEntry entry(planes, capture, center, tile.crop);
    float off = entry.difference(nearest, dc, unusable);
    if (farthest) off = std::max(off, entry.difference(*farthest, dc, unusable));
    return off + step;
  };
  m.dz_cuboid = off_proxy(box_planes(object.box_min, object.box_max));
  const std::vector<Plane> hull = object.hull.planes();
  m.dz_hull = hull.empty() ? m.dz_cuboid : off_proxy(hull);
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
