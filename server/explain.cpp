#include "server/explain.h"

#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include "protocol/sun_frame.h"

namespace mirage {
namespace {

struct Rule {
  Need need;
  const char* feature;
};
constexpr Rule kRules[] = {
    {kNeedLighting, "lighting"},
    {kNeedBlend, "blending"},
    {kNeedAlphaMask, "alpha test"},
    {kNeedVertexColor, "vertex colour"},
    {kNeedBaseColorMap, "base colour map"},
    {kNeedMetalRoughMap, "metal-rough map"},
    {kNeedNormalMap, "normal map"},
    {kNeedOcclusionMap, "occlusion map"},
    {kNeedEmissiveMap, "emissive map"},
    {kNeedTextureTransform, "texture transform"},
    {kNeedUv1, "second texture coordinates"},
    {kNeedShadowPass, "casting shadows"},
};

// Whether there is a shadow pass, and why not.
std::string explain_shadows(const PreparedScene& prepared, bool asked) {
  if (!asked) return "left out: --shadows is off";
  if (!prepared.has_casters()) return "left out: nothing casts any";
  if (!sun_of(prepared.scene.lighting)) return "left out while no client sets a light with a sun";
  return "the sun's";
}

}  // namespace

std::string explain_needs(const PreparedScene& prepared, bool shadows, bool json) {
  nlohmann::json out = nlohmann::json::array();
  std::string text = fmt::format("{}: {} objects, {} instances, {} triangles\n",
                                 prepared.scene.name, prepared.scene.objects.size(),
                                 prepared.scene.instances.size(), prepared.scene.triangles());
  text += fmt::format("  shadows: {}\n", explain_shadows(prepared, shadows));
  for (std::size_t i = 0; i < prepared.scene.objects.size(); ++i) {
    const ObjectDescription& object = prepared.objects[i];
    const std::string& name = prepared.scene.objects[i].name;
    nlohmann::json needed = nlohmann::json::array(), left_out = nlohmann::json::array();
    std::string left;
    for (const Rule& rule : kRules) {
      const bool used = object.needs & rule.need;
      (used ? needed : left_out).push_back(rule.feature);
      if (!used) left += (left.empty() ? "" : ", ") + std::string(rule.feature);
    }
    out.push_back({{"object", i},
                   {"name", name},
                   {"triangles", object.triangles},
                   {"radius", object.radius},
                   {"needed", needed},
                   {"left_out", left_out}});
    text += fmt::format("  {:4} {:<28} {:>8} triangles, radius {:.3g} m; left out: {}\n", i, name,
                        object.triangles, object.radius, left);
  }
  return json ? out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n" : text;
}

}  // namespace mirage
