#include "client/draw/impostor_atlas.h"

#include <algorithm>
#include <cstring>

#include "protocol/codec/tile_color.h"

namespace mirage {
namespace {

// Gives empty texels beside covered ones the nearest neighbour's depth. Bilinear colour reaches
// half a texel beyond the covered ones, and needs a depth there.
std::vector<std::uint8_t> grown_depth(const std::vector<std::uint8_t>& depth, std::size_t w,
                                      std::size_t h) {
  std::vector<std::uint8_t> out = depth;
  for (std::size_t y = 0; y < h; ++y) {
    for (std::size_t x = 0; x < w; ++x) {
      std::uint8_t& code = out[y * w + x];
      if (code != 0) continue;
      for (std::size_t ny = y > 0 ? y - 1 : 0; ny <= std::min(y + 1, h - 1); ++ny) {
        for (std::size_t nx = x > 0 ? x - 1 : 0; nx <= std::min(x + 1, w - 1); ++nx) {
          const std::uint8_t there = depth[ny * w + nx];
          if (there != 0 && (code == 0 || there < code)) code = there;
        }
      }
    }
  }
  return out;
}

// Returns `plane` with an empty texel around it.
std::vector<std::uint8_t> with_gutter(const std::vector<std::uint8_t>& plane, std::size_t w,
                                      std::size_t h, std::size_t bytes) {
  std::vector<std::uint8_t> out((w + 2) * (h + 2) * bytes, 0);
  for (std::size_t y = 0; y < h; ++y) {
    std::memcpy(&out[((y + 1) * (w + 2) + 1) * bytes], &plane[y * w * bytes], w * bytes);
  }
  return out;
}

// Returns the surface with a gutter. Empty texels beside covered ones get the mean normal and
// roughness of those and the material of one, because bilinear colour reaches them, too.
std::vector<std::uint8_t> grown_surface(const TilePixels& pixels, std::size_t w, std::size_t h) {
  const std::size_t pw = w + 2, ph = h + 2;
  std::vector<std::uint8_t> out(pw * ph * 4, 0);
  // Takes coordinates of the plane with its gutter.
  const auto covered = [&](std::size_t x, std::size_t y) {
    return x >= 1 && y >= 1 && x <= w && y <= h && pixels.rgba[((y - 1) * w + x - 1) * 4 + 3] != 0;
  };
  for (std::size_t y = 0; y < ph; ++y) {
    for (std::size_t x = 0; x < pw; ++x) {
      std::uint8_t* to = &out[(y * pw + x) * 4];
      if (covered(x, y)) {
        std::memcpy(to, &pixels.surface[((y - 1) * w + x - 1) * 4], 4);
        continue;
      }
      unsigned sum[3] = {0, 0, 0}, count = 0;
      for (std::size_t ny = y > 0 ? y - 1 : 0; ny <= std::min(y + 1, ph - 1); ++ny) {
        for (std::size_t nx = x > 0 ? x - 1 : 0; nx <= std::min(x + 1, pw - 1); ++nx) {
          if (!covered(nx, ny)) continue;
          const std::uint8_t* from = &pixels.surface[((ny - 1) * w + nx - 1) * 4];
          for (int c = 0; c < 3; ++c) sum[c] += from[c];
          to[3] = from[3];
          ++count;
        }
      }
      for (int c = 0; c < 3 && count > 0; ++c) {
        to[c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
      }
    }
  }
  return out;
}

}  // namespace

Result<ImpostorAtlas> ImpostorAtlas::create(int edge, int layers) {
  GLint most_layers = 0, longest = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most_layers);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &longest);
  if (layers > most_layers || edge > longest) {
    return make_error(ErrorId::kGraphicsGl, "the atlas has more layers than the device can",
                      "--atlas-mb takes less");
  }
  ImpostorAtlas atlas;
  atlas.color_ = LayeredTexture({GL_SRGB8_ALPHA8, GL_LINEAR}, edge, layers);
  atlas.depth_ = LayeredTexture({GL_R8, GL_NEAREST}, edge, layers);
  atlas.surface_ = LayeredTexture({GL_RGBA8, GL_LINEAR}, edge, layers);
  return atlas;
}

Result<void> ImpostorAtlas::upload(const TileRecord& record, const TilePixels& pixels) {
  const std::size_t w = record.crop.w, h = record.crop.h, pw = w + 2, ph = h + 2;
  const auto put = [&](LayeredTexture& plane, const AtlasSlot& s,
                       const std::vector<std::uint8_t>& texels) {
    return plane.upload(s.layer, s.x, s.y, static_cast<int>(pw), static_cast<int>(ph),
                        texels.data());
  };
  const auto put_color = [&](const AtlasSlot& slot, const std::vector<std::uint8_t>& rgba) {
    return put(color_, slot, with_gutter(rgba, w, h, 4));
  };
  const auto put_depth = [&](const AtlasSlot& slot, const std::vector<std::uint8_t>& codes) {
    return put(depth_, slot, with_gutter(codes, w, h, 1));
  };
  // Flat methods draw both layers as one picture.
  const bool both = !pixels.behind.empty();
  Result<void> done =
      put_color(record.slot, both ? front_over_behind(pixels.rgba, pixels.behind) : pixels.rgba);
  if (done) {
    done = put(depth_, record.slot, grown_depth(with_gutter(record.depth, w, h, 1), pw, ph));
  }
  if (done && record.layered()) {
    done = put_color(record.front_slot, pixels.rgba);
    if (done) done = put_depth(record.front_slot, record.depth);
    if (done) done = put_color(record.behind_slot, pixels.behind);
    if (done) done = put_depth(record.behind_slot, record.behind_depth);
  }
  if (done && record.relit) done = put(surface_, record.slot, grown_surface(pixels, w, h));
  return done;
}

void ImpostorAtlas::bind(bool relit) const {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, color_.id());
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D_ARRAY, depth_.id());
  if (!relit) return;
  glActiveTexture(GL_TEXTURE3);
  glBindTexture(GL_TEXTURE_2D_ARRAY, surface_.id());
}

}  // namespace mirage
