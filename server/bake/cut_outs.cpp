#include "server/bake/cut_outs.h"

#include "server/scene/scene.h"

namespace mirage {
namespace {

constexpr int kAbsent = 26, kPresent = 229;  // a tenth of 255 from either end
constexpr double kMostBetween = 0.25;        // share of texels that soft edges may take

bool is_cut_out(const Material& material, const Scene& scene) {
  if (material.alpha_mode != AlphaMode::kBlend || !material.base_color_map.present()) return false;
  if (material.base_color.a < 0.5f) return false;
  const auto image = static_cast<std::size_t>(material.base_color_map.image);
  if (image >= scene.images.size()) return false;
  std::size_t between = 0, absent = 0;
  const std::vector<std::uint8_t>& rgba = scene.images[image].rgba;
  for (std::size_t i = 3; i < rgba.size(); i += 4) {
    between += rgba[i] >= kAbsent && rgba[i] <= kPresent;
    absent += rgba[i] < kAbsent;
  }
  return absent > 0 && double(between) <= kMostBetween * double(rgba.size()) / 4;
}

}  // namespace

std::size_t test_cut_outs(Scene& scene) {
  std::size_t changed = 0;
  for (Material& material : scene.materials) {
    if (!is_cut_out(material, scene)) continue;
    material.alpha_mode = AlphaMode::kMask;
    material.alpha_cutoff = 0.5f;
    ++changed;
  }
  return changed;
}

}  // namespace mirage
