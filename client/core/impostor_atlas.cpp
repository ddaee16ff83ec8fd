#include "client/core/impostor_atlas.h"

#include <algorithm>
#include <cstring>

namespace mirage {
namespace {

gl::Texture make_layers(GLenum format, GLenum layout, GLint filter, int edge, int layers) {
  gl::Texture texture = gl::Texture::create();
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture.id());
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, static_cast<GLint>(format), edge, edge, layers, 0, layout,
               GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

// Empty texels beside covered ones get the nearest neighbour's depth: bilinear colour reaches half
// a texel past the covered ones, and needs a depth there.
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

// The surface with a gutter; empty texels beside covered ones get the mean normal and roughness of
// those and the material of one, for the same reason.
std::vector<std::uint8_t> grown_surface(const TilePixels& pixels, std::size_t w, std::size_t h) {
  const std::size_t pw = w + 2, ph = h + 2;
  std::vector<std::uint8_t> out(pw * ph * 4, 0);
  const auto covered = [&](std::size_t x, std::size_t y) {  // in the gutter's coordinates
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
  while (glGetError() != GL_NO_ERROR) {
  }
  ImpostorAtlas atlas;
  atlas.color_ = make_layers(GL_SRGB8_ALPHA8, GL_RGBA, GL_LINEAR, edge, layers);
  atlas.depth_ = make_layers(GL_R8, GL_RED, GL_NEAREST, edge, layers);
  if (glGetError() != GL_NO_ERROR) {
    return make_error(ErrorId::kGraphicsGl, "the atlas does not fit the graphics memory",
                      "--atlas-mb takes less");
  }
  atlas.edge_ = edge;
  atlas.layers_ = layers;
  atlas.gpu_bytes_ = static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge) *
                     static_cast<std::size_t>(layers) * 5;
  return atlas;
}

void ImpostorAtlas::upload(const TileRecord& record, const TilePixels& pixels) {
  const std::vector<std::uint8_t>& rgba = pixels.rgba;
  const std::size_t w = record.crop.w, h = record.crop.h, pw = w + 2, ph = h + 2;
  std::vector<std::uint8_t> color(pw * ph * 4, 0), depth(pw * ph, 0);
  for (std::size_t y = 0; y < h; ++y) {
    std::memcpy(&color[((y + 1) * pw + 1) * 4], &rgba[y * w * 4], w * 4);
    std::memcpy(&depth[(y + 1) * pw + 1], &record.depth[y * w], w);
  }
  depth = grown_depth(depth, pw, ph);
  const AtlasSlot& s = record.slot;
  const auto gw = static_cast<GLsizei>(pw), gh = static_cast<GLsizei>(ph);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glBindTexture(GL_TEXTURE_2D_ARRAY, color_.id());
  glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, s.x, s.y, s.layer, gw, gh, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                  color.data());
  glBindTexture(GL_TEXTURE_2D_ARRAY, depth_.id());
  glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, s.x, s.y, s.layer, gw, gh, 1, GL_RED, GL_UNSIGNED_BYTE,
                  depth.data());
  if (record.relit) upload_surface(s, grown_surface(pixels, w, h), gw, gh);
}

void ImpostorAtlas::upload_surface(const AtlasSlot& s, const std::vector<std::uint8_t>& surface,
                                   int w, int h) {
  if (surface_.id() == 0) {
    surface_ = make_layers(GL_RGBA8, GL_RGBA, GL_LINEAR, edge_, layers_);
    gpu_bytes_ += gpu_bytes_ / 5 * 4;
  }
  glBindTexture(GL_TEXTURE_2D_ARRAY, surface_.id());
  glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, s.x, s.y, s.layer, w, h, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                  surface.data());
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
