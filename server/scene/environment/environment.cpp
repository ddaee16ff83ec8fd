#include "server/scene/environment/environment.h"

#include <algorithm>

#include "server/scene/environment/builtin_environment.h"
#include "server/scene/environment/environment_file.h"
#include "server/scene/environment/probe_filter.h"
#include "server/scene/environment/studio_probe.h"

namespace mirage {
namespace {

// Backdrop, linear: light enough for dark models and dark enough for white ones.
const glm::vec3 kStudioZenith{0.13f, 0.135f, 0.145f};
const glm::vec3 kStudioHorizon{0.42f, 0.425f, 0.435f};
const glm::vec3 kStudioNadir{0.20f, 0.205f, 0.215f};
const glm::vec3 kStudioFloor{0.36f, 0.365f, 0.375f};

bool is_studio(const std::string& spec) { return spec.empty() || spec == "builtin:studio"; }

}  // namespace

Result<Equirect> surroundings(const std::string& spec, std::vector<std::string>& warnings) {
  const std::string builtin = "builtin:";
  if (!spec.empty() && spec.rfind(builtin, 0) != 0) return read_environment(spec, warnings);
  std::optional<Equirect> image =
      builtin_environment(spec.empty() ? "studio" : spec.substr(builtin.size()));
  if (image) return std::move(*image);
  return make_error(ErrorId::kUsage, "unknown environment '" + spec + "'",
                    "builtin:studio, builtin:sky, none or a .hdr or .exr file");
}

Result<void> set_environment(const std::string& spec, Scene& scene, const Workers& workers) {
  if (spec == "none" || (spec.empty() && scene.own_lights)) return {};
  const bool lit = std::any_of(scene.materials.begin(), scene.materials.end(),
                               [](const Material& m) { return !m.unlit; });
  if (is_studio(spec)) {
    if (!lit) return {};
    scene.probe = std::make_shared<const LightProbe>(studio_probe());
  } else {
    Result<Equirect> image = surroundings(spec, scene.warnings);
    if (!image) return image.error();
    if (!lit) return {};
    scene.probe = std::make_shared<const LightProbe>(make_probe(*image, workers));
  }
  if (!scene.own_lights) scene.lighting.lights.clear();
  scene.lighting.ambient = glm::vec3(0);
  scene.lighting.probe = {};
  scene.lighting.probe.id = scene.probe->id;
  return {};
}

void set_look(bool studio, const std::string& spec, Scene& scene) {
  Environment& environment = scene.environment;
  if (!studio || !is_studio(spec) || scene.own_lights) {
    environment.floor = {};
    return;
  }
  environment.zenith = kStudioZenith;
  environment.horizon = kStudioHorizon;
  environment.nadir = kStudioNadir;
  environment.floor.color = kStudioFloor;
  environment.tone = ToneCurve::kNeutral;
}

}  // namespace mirage
