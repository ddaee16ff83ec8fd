#include "protocol/codec/atlas_planes.h"

#include <algorithm>
#include <cstring>

#include "protocol/codec/tile_color.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int kShadowRings = 3;  // texels by which shadows continue beyond the content

// A plane; kAtlasShapes lists all in the order of their bytes.
struct AtlasShape {
  Bytes AtlasPlanes::*plane;
  std::uint8_t channel;  // the plane exists if the tile has this channel
  std::size_t bytes;     // per texel
};
constexpr AtlasShape kAtlasShapes[] = {
    {&AtlasPlanes::color, kChannelColor, 4},
    {&AtlasPlanes::depth, kChannelDepth, 1},
    {&AtlasPlanes::surface, kChannelNormal, 4},
    {&AtlasPlanes::front_color, kChannelBehind, 4},
    {&AtlasPlanes::front_depth, kChannelBehind, 1},
    {&AtlasPlanes::behind_color, kChannelBehind, 4},
    {&AtlasPlanes::behind_depth, kChannelBehind, 1},
    {&AtlasPlanes::shadow, kChannelShadow, 1},
};

std::size_t shape_bytes(const AtlasShape& shape, const TileCrop& crop, std::uint8_t channels) {
  if (!(channels & shape.channel) || crop.area() == 0) return 0;
  return (std::size_t{crop.w} + 2) * (crop.h + 2) * shape.bytes;
}

// Returns a plane of the crop's size with an empty texel around it.
Bytes with_gutter(const Bytes& plane, const TileCrop& crop, std::size_t bytes) {
  const std::size_t w = crop.w, h = crop.h;
  Bytes out((w + 2) * (h + 2) * bytes, 0);
  for (std::size_t y = 0; y < h; ++y) {
    std::memcpy(&out[((y + 1) * (w + 2) + 1) * bytes], &plane[y * w * bytes], w * bytes);
  }
  return out;
}

// Calls visit(place) for each neighbour of the texel x, y in a plane of w by h, and for itself.
template <typename Visit>
void visit_around(std::size_t x, std::size_t y, std::size_t w, std::size_t h, const Visit& visit) {
  for (std::size_t ny = y > 0 ? y - 1 : 0; ny <= std::min(y + 1, h - 1); ++ny) {
    for (std::size_t nx = x > 0 ? x - 1 : 0; nx <= std::min(x + 1, w - 1); ++nx) visit(ny * w + nx);
  }
}

// Gives empty texels beside covered ones the nearest neighbour's depth. Bilinear colour reaches
// half a texel beyond the covered ones, and needs a depth there.
Bytes grown_depth(const Bytes& depth, std::size_t w, std::size_t h) {
  Bytes out = depth;
  for (std::size_t y = 0; y < h; ++y) {
    for (std::size_t x = 0; x < w; ++x) {
      std::uint8_t& code = out[y * w + x];
      if (code != 0) continue;
      visit_around(x, y, w, h, [&](std::size_t at) {
        if (depth[at] != 0 && (code == 0 || depth[at] < code)) code = depth[at];
      });
    }
  }
  return out;
}

// Gives empty texels beside covered ones the mean normal and roughness of those and the material of
// one, because bilinear colour reaches them, too. `color` tells which are covered.
Bytes grown_surface(const Bytes& surface, const Bytes& color, std::size_t w, std::size_t h) {
  Bytes out(surface.size(), 0);
  for (std::size_t y = 0; y < h; ++y) {
    for (std::size_t x = 0; x < w; ++x) {
      std::uint8_t* to = &out[(y * w + x) * 4];
      if (color[(y * w + x) * 4 + 3] != 0) {
        std::memcpy(to, &surface[(y * w + x) * 4], 4);
        continue;
      }
      unsigned sum[3] = {0, 0, 0}, count = 0;
      visit_around(x, y, w, h, [&](std::size_t at) {
        if (color[at * 4 + 3] == 0) return;
        const std::uint8_t* from = &surface[at * 4];
        for (int c = 0; c < 3; ++c) sum[c] += from[c];
        to[3] = from[3];
        ++count;
      });
      for (int c = 0; c < 3 && count > 0; ++c) {
        to[c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
      }
    }
  }
  return out;
}

// Gives texels of 0 beside others the mean of those.
Bytes grown_shadow(const Bytes& in, std::size_t w, std::size_t h) {
  Bytes out = in;
  for (std::size_t y = 0; y < h; ++y) {
    for (std::size_t x = 0; x < w; ++x) {
      if (in[y * w + x] != 0) continue;
      unsigned sum = 0, count = 0;
      visit_around(x, y, w, h, [&](std::size_t at) {
        sum += in[at];
        count += in[at] != 0 ? 1 : 0;
      });
      if (count > 0) out[y * w + x] = static_cast<std::uint8_t>((sum + count / 2) / count);
    }
  }
  return out;
}

Bytes shadow_plane(const Tile& tile) {
  Bytes out = with_gutter(tile.shadow, tile.crop, 1);
  for (int i = 0; i < kShadowRings; ++i) {
    out = grown_shadow(out, std::size_t{tile.crop.w} + 2, std::size_t{tile.crop.h} + 2);
  }
  // Maps 1..255 to 0..255. Texels that are still empty lie far from any surface.
  for (std::uint8_t& t : out) {
    t = static_cast<std::uint8_t>(t == 0 ? 255 : ((t - 1) * 255 + 127) / 254);
  }
  return out;
}

}  // namespace

AtlasPlanes atlas_planes(const Tile& tile) {
  AtlasPlanes out;
  if (tile.crop.area() == 0) return out;
  const std::size_t pw = std::size_t{tile.crop.w} + 2, ph = std::size_t{tile.crop.h} + 2;
  if (tile.channels & kChannelShadow) out.shadow = shadow_plane(tile);
  if (tile.channels & kChannelDepth) out.depth = with_gutter(tile.depth, tile.crop, 1);
  if (!is_picture(tile.channels)) return out;
  if (tile.layered()) {
    out.front_color = with_gutter(tile.rgba, tile.crop, 4);
    out.front_depth = out.depth;
    out.behind_color = with_gutter(tile.behind, tile.crop, 4);
    out.behind_depth = with_gutter(tile.behind_depth, tile.crop, 1);
    // Flat methods draw both layers as one picture.
    out.color = front_over_behind(out.front_color, out.behind_color);
  } else {
    out.color = with_gutter(tile.rgba, tile.crop, 4);
  }
  out.depth = grown_depth(out.depth, pw, ph);
  if (tile.relit()) {
    out.surface = grown_surface(with_gutter(tile.surface, tile.crop, 4), out.color, pw, ph);
  }
  return out;
}

std::size_t atlas_plane_bytes(const TileCrop& crop, std::uint8_t channels) {
  std::size_t bytes = 0;
  for (const AtlasShape& shape : kAtlasShapes) bytes += shape_bytes(shape, crop, channels);
  return bytes;
}

void append_atlas_planes(const AtlasPlanes& planes, std::vector<std::uint8_t>& out) {
  for (const AtlasShape& shape : kAtlasShapes) {
    const Bytes& plane = planes.*shape.plane;
    out.insert(out.end(), plane.begin(), plane.end());
  }
}

Result<AtlasPlanes> read_atlas_planes(const std::uint8_t* bytes, std::size_t size,
                                      const TileCrop& crop, std::uint8_t channels) {
  if (size != atlas_plane_bytes(crop, channels)) {
    return make_error(ErrorId::kCodec, "the planes of a tile are not of its size");
  }
  AtlasPlanes out;
  for (const AtlasShape& shape : kAtlasShapes) {
    const std::size_t count = shape_bytes(shape, crop, channels);
    (out.*shape.plane).assign(bytes, bytes + count);
    bytes += count;
  }
  return out;
}

}  // namespace mirage
