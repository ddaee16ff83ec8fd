#include "client/draw/shadow_atlas.h"

#include <algorithm>
#include <cstring>

namespace mirage {
namespace {

constexpr int kRings = 3;  // texels by which shadows continue beyond the content

// Returns the plane with a gutter of one texel, which is 0.
std::vector<std::uint8_t> with_gutter(const TileCrop& crop,
                                      const std::vector<std::uint8_t>& plane) {
  const std::size_t w = crop.w, h = crop.h, pw = w + 2;
  std::vector<std::uint8_t> out(pw * (h + 2), 0);
  for (std::size_t y = 0; y < h; ++y) {
    std::memcpy(&out[(y + 1) * pw + 1], &plane[y * w], w);
  }
  return out;
}

// Gives texels of 0 beside others the mean of those.
std::vector<std::uint8_t> grown(const std::vector<std::uint8_t>& in, std::size_t w, std::size_t h) {
  std::vector<std::uint8_t> out = in;
  for (std::size_t y = 0; y < h; ++y) {
    for (std::size_t x = 0; x < w; ++x) {
      if (in[y * w + x] != 0) continue;
      unsigned sum = 0, count = 0;
      for (std::size_t ny = y > 0 ? y - 1 : 0; ny <= std::min(y + 1, h - 1); ++ny) {
        for (std::size_t nx = x > 0 ? x - 1 : 0; nx <= std::min(x + 1, w - 1); ++nx) {
          sum += in[ny * w + nx];
          count += in[ny * w + nx] != 0 ? 1 : 0;
        }
      }
      if (count > 0) out[y * w + x] = static_cast<std::uint8_t>((sum + count / 2) / count);
    }
  }
  return out;
}

}  // namespace

Result<void> ShadowAtlas::upload_caster(const ShadowRecord& record,
                                        const std::vector<std::uint8_t>& codes) {
  if (record.crop.area() == 0) return {};
  return upload(record.slot, with_gutter(record.crop, codes));
}

Result<void> ShadowAtlas::upload_shadow(const ShadowRecord& record,
                                        const std::vector<std::uint8_t>& shares) {
  if (record.crop.area() == 0) return {};
  std::vector<std::uint8_t> texels = with_gutter(record.crop, shares);
  for (int i = 0; i < kRings; ++i) texels = grown(texels, record.crop.w + 2, record.crop.h + 2);
  // Maps 1..255 to 0..255. Texels that are still empty lie far from any surface.
  for (std::uint8_t& t : texels) {
    t = static_cast<std::uint8_t>(t == 0 ? 255 : ((t - 1) * 255 + 127) / 254);
  }
  return upload(record.slot, texels);
}

Result<void> ShadowAtlas::upload(const AtlasSlot& slot, const std::vector<std::uint8_t>& texels) {
  return layers_.upload(slot.layer, slot.x, slot.y, slot.w, slot.h, texels.data());
}

}  // namespace mirage
