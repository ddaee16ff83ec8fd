#include "server/prepare/leave_out_lobes.h"

#include <algorithm>

namespace mirage {

TexelRange texel_range(const Image& image) {
  constexpr std::size_t kAtOnce = 16;  // bytes: the compiler uses one instruction for them
  std::array<std::uint8_t, kAtOnce> low, high;
  low.fill(255);
  high.fill(0);
  const std::uint8_t* const rgba = image.rgba.data();
  const std::size_t size = image.rgba.size(), whole = size / kAtOnce * kAtOnce;
  for (std::size_t i = 0; i < whole; i += kAtOnce) {
    for (std::size_t k = 0; k < kAtOnce; ++k) {
      low[k] = std::min(low[k], rgba[i + k]);
      high[k] = std::max(high[k], rgba[i + k]);
    }
  }
  for (std::size_t i = whole; i < size; ++i) {
    low[i % 4] = std::min(low[i % 4], rgba[i]);
    high[i % 4] = std::max(high[i % 4], rgba[i]);
  }
  TexelRange out;
  for (std::size_t k = 0; k < kAtOnce; ++k) {
    out.low[k % 4] = std::min(out.low[k % 4], low[k]);
    out.high[k % 4] = std::max(out.high[k % 4], high[k]);
  }
  return out;
}

namespace {

class LobeAnalysis {
 public:
  LobeAnalysis(Lobes& lobes, const std::function<TexelRange(const TextureRef&)>& range_of,
               std::vector<LeftOut>& out)
      : lobes_(lobes), range_of_(range_of), out_(out) {}

  void all() {
    const Lobes plain;
    drop_white(LobeMap::kSpecular, {3}, "specular map");
    drop_white(LobeMap::kSpecularColor, {0, 1, 2}, "specular colour map");
    drop_white(LobeMap::kClearcoat, {0}, "clearcoat map");
    drop_white(LobeMap::kClearcoatRoughness, {1}, "clearcoat roughness map");
    drop_white(LobeMap::kSheenColor, {0, 1, 2}, "sheen colour map");
    drop_white(LobeMap::kTransmission, {0}, "transmission map");
    if (lobes_.clearcoat == 0 || black(LobeMap::kClearcoat, {0})) {
      gone("clearcoat", lobes_.clearcoat > 0,
           {LobeMap::kClearcoat, LobeMap::kClearcoatRoughness, LobeMap::kClearcoatNormal});
      lobes_.clearcoat = plain.clearcoat;
      lobes_.clearcoat_roughness = plain.clearcoat_roughness;
    }
    if (lobes_.sheen_color == glm::vec3(0) || black(LobeMap::kSheenColor, {0, 1, 2})) {
      gone("sheen", lobes_.sheen_color != glm::vec3(0), {LobeMap::kSheenColor});
      lobes_.sheen_color = plain.sheen_color;
      lobes_.sheen_roughness = plain.sheen_roughness;
    }
    if (lobes_.transmission == 0 || black(LobeMap::kTransmission, {0})) {
      gone("transmission", lobes_.transmission > 0, {LobeMap::kTransmission});
      lobes_.transmission = plain.transmission;
      lobes_.volume_tint = plain.volume_tint;
    }
    // The map holds directions, and no 8-bit texel means "none". Only a strength of 0 is neutral.
    if (lobes_.anisotropy == 0 || black(LobeMap::kAnisotropy, {2})) {
      gone("anisotropy", lobes_.anisotropy > 0, {LobeMap::kAnisotropy});
      lobes_.anisotropy = plain.anisotropy;
      lobes_.anisotropy_rotation = plain.anisotropy_rotation;
    }
  }

 private:
  using Channels = std::vector<std::size_t>;
  bool always(LobeMap which, const Channels& channels, std::uint8_t value) const {
    const TextureRef& map = lobes_.map(which);
    if (!map.present()) return false;
    const TexelRange range = range_of_(map);
    return std::all_of(channels.begin(), channels.end(),
                       [&](std::size_t c) { return range.always(c, value); });
  }
  bool black(LobeMap which, const Channels& channels) const { return always(which, channels, 0); }
  void drop_white(LobeMap which, const Channels& channels, const char* what) {
    if (!always(which, channels, 255)) return;
    out_.push_back({NeedRule::kExtensions, what, "1 in every texel"});
    lobes_.map(which) = {};
  }
  void gone(const char* what, bool by_map, const std::vector<LobeMap>& maps) {
    bool had = by_map;
    for (const LobeMap which : maps) {
      had = had || lobes_.map(which).present();
      lobes_.map(which) = {};
    }
    const char* why = by_map ? "black in every texel" : "its factor is 0";
    if (had) out_.push_back({NeedRule::kExtensions, what, why});
  }

  Lobes& lobes_;
  const std::function<TexelRange(const TextureRef&)>& range_of_;
  std::vector<LeftOut>& out_;
};

}  // namespace

void leave_out_lobes(Material& material,
                     const std::function<TexelRange(const TextureRef&)>& range_of,
                     std::vector<LeftOut>& out) {
  if (material.unlit) {
    material.lobes = {};
    return;
  }
  LobeAnalysis(material.lobes, range_of, out).all();
}

}  // namespace mirage
