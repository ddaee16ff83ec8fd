#include "shaders/gl/mesh_variants.h"

namespace mirage::gl {
namespace {

struct NeedDefine {
  NeedMask need;
  const char* define;
};
constexpr NeedDefine kDefines[] = {
    {kNeedLighting, "NEED_LIGHTING"},
    {kNeedBaseColorMap, "NEED_BASE_COLOR_MAP"},
    {kNeedMetalRoughMap, "NEED_METAL_ROUGH_MAP"},
    {kNeedNormalMap, "NEED_NORMAL_MAP"},
    {kNeedOcclusionMap, "NEED_OCCLUSION_MAP"},
    {kNeedEmissiveMap, "NEED_EMISSIVE_MAP"},
    {kNeedAlphaMask, "NEED_ALPHA_MASK"},
    {kNeedBlend, "NEED_BLEND"},
    {kNeedVertexColor, "NEED_VERTEX_COLOR"},
    {kFog, "FOG"},
    {kFade, "FADE"},
    {kShadow, "SHADOW"},
    {kProbe, "PROBE"},
    {kDepthOnly, "DEPTH_ONLY"},
    {kSwitches, "SWITCHES"},
    {kNeedReflectance, "NEED_REFLECTANCE"},
    {kNeedClearcoat, "NEED_CLEARCOAT"},
    {kNeedSheen, "NEED_SHEEN"},
    {kNeedTransmission, "NEED_TRANSMISSION"},
    {kNeedAnisotropy, "NEED_ANISOTROPY"},
};

struct LobeMapNames {
  const char* define;
  const char* sampler;
};
// Names in the order of LobeMap.
constexpr LobeMapNames kLobeMapNames[kLobeMaps] = {
    {"NEED_SPECULAR_MAP", "u_specular_map"},
    {"NEED_SPECULAR_COLOR_MAP", "u_specular_color_map"},
    {"NEED_CLEARCOAT_MAP", "u_clearcoat_map"},
    {"NEED_CLEARCOAT_ROUGHNESS_MAP", "u_clearcoat_roughness_map"},
    {"NEED_CLEARCOAT_NORMAL_MAP", "u_clearcoat_normal_map"},
    {"NEED_SHEEN_COLOR_MAP", "u_sheen_color_map"},
    {"NEED_TRANSMISSION_MAP", "u_transmission_map"},
    {"NEED_ANISOTROPY_MAP", "u_anisotropy_map"},
};

}  // namespace

const char* lobe_map_sampler(std::size_t i) { return kLobeMapNames[i].sampler; }

std::vector<std::string> variant_defines(NeedMask needs) {
  std::vector<std::string> defines;
  for (const NeedDefine& d : kDefines) {
    if (needs & d.need) defines.emplace_back(d.define);
  }
  for (std::size_t i = 0; i < kLobeMaps; ++i) {
    if (needs & lobe_map_need(i)) defines.emplace_back(kLobeMapNames[i].define);
  }
  if (needs & kLobeNeeds) defines.emplace_back("LOBES");
  return defines;
}

}  // namespace mirage::gl
