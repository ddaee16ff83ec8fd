#include "protocol/model/need_mask.h"

#include <algorithm>
#include <initializer_list>

namespace mirage {
namespace {

bool is_transformed(const TextureRef& t) {
  return t.present() && (t.offset != glm::vec2(0) || t.scale != glm::vec2(1) || t.rotation != 0.0f);
}

NeedMask lobe_needs(const Lobes& lobes) {
  NeedMask needs = 0;
  const bool reflects = lobes.specular != 1 || lobes.specular_color != glm::vec3(1) ||
                        lobes.ior != 1.5f || lobes.map(LobeMap::kSpecular).present() ||
                        lobes.map(LobeMap::kSpecularColor).present();
  if (reflects) needs |= kNeedReflectance;
  if (lobes.clearcoat > 0) needs |= kNeedClearcoat;
  if (lobes.sheen_color != glm::vec3(0)) needs |= kNeedSheen;
  if (lobes.transmission > 0) needs |= kNeedTransmission;
  if (lobes.anisotropy > 0) needs |= kNeedAnisotropy;
  for (std::size_t i = 0; i < kLobeMaps; ++i) {
    const bool read = needs & lobe_of(static_cast<LobeMap>(i));
    if (read && lobes.maps[i].present()) needs |= NeedMask{kNeedFirstLobeMap} << i;
  }
  return needs;
}

}  // namespace

NeedMask lobe_of(LobeMap map) {
  switch (map) {
    case LobeMap::kSpecular:
    case LobeMap::kSpecularColor:
      return kNeedReflectance;
    case LobeMap::kSheenColor:
      return kNeedSheen;
    case LobeMap::kTransmission:
      return kNeedTransmission;
    case LobeMap::kAnisotropy:
      return kNeedAnisotropy;
    default:
      return kNeedClearcoat;
  }
}

bool has_vertex_color(const Mesh& mesh) {
  for (const Vertex& v : mesh.vertices) {
    if (v.color != glm::u16vec4(65535)) return true;
  }
  return false;
}

NeedMask material_needs(const Material& m, bool vertex_color) {
  NeedMask needs = 0;
  if (m.base_color_map.present()) needs |= kNeedBaseColorMap;
  if (m.alpha_mode == AlphaMode::kMask) needs |= kNeedAlphaMask;
  if (m.alpha_mode == AlphaMode::kBlend) needs |= kNeedBlend;
  if (m.alpha_mode != AlphaMode::kBlend) needs |= kNeedShadowPass;
  if (vertex_color) needs |= kNeedVertexColor;
  if (!m.unlit) {
    needs |= kNeedLighting;
    // Specular is never neutral: in glTF's model a dielectric of roughness 1 keeps a faint lobe.
    needs |= kNeedSpecular;
    if (m.metal_rough_map.present()) needs |= kNeedMetalRoughMap;
    if (m.normal_map.present() && m.normal_scale != 0.0f) needs |= kNeedNormalMap;
    if (m.occlusion_map.present() && m.occlusion_strength != 0.0f) needs |= kNeedOcclusionMap;
    if (m.emissive_map.present() && m.emissive != glm::vec3(0)) needs |= kNeedEmissiveMap;
    if (m.emissive != glm::vec3(0)) needs |= kNeedEmissive;
    needs |= lobe_needs(m.lobes);
  } else {
    needs |= kNeedUnlit;
  }
  m.each_map([&](const TextureRef& t) {
    if (is_transformed(t)) needs |= kNeedTextureTransform;
    if (t.present() && t.uv_set == 1) needs |= kNeedUv1;
  });
  return needs;
}

float alpha_test_cutoff(std::int32_t image, const std::vector<Material>& materials) {
  for (const Material& m : materials) {
    const bool uses = m.base_color_map.image == image;
    if (uses && m.alpha_mode == AlphaMode::kMask && m.base_color.a > 0) {
      return std::max(m.alpha_cutoff, 0.0f) / m.base_color.a;
    }
  }
  return 0;
}

NeedMask object_needs(const Mesh& mesh, const std::vector<Material>& materials) {
  NeedMask needs = 0;
  const bool vertex_color = has_vertex_color(mesh);
  for (const Primitive& p : mesh.primitives) {
    needs |= material_needs(materials[p.material], vertex_color);
  }
  return needs;
}

}  // namespace mirage
