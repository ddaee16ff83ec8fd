#include "server/scene/gltf/light_import.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/gtc/constants.hpp>
#include <optional>

#include "server/scene/gltf/gltf_limits.h"

namespace mirage::gltf {
namespace {

constexpr float kAmbientWithLights = 0.1f;
constexpr float kDefaultAmbient = 0.6f;
constexpr float kDefaultKeyLight = 0.8f;  // 2.5 over pi: our colours are irradiance over pi
constexpr double kMaxIntensity = 1e9;
/// Largest plausible sum of light colours at the middle of the scene before exposure.
constexpr double kWellExposed = 1.5;
/// A light nearer to the middle than this share of the radius is evaluated at this distance.
constexpr double kNearestShare = 0.25;
constexpr double kSmallestCone = 0.02;  // rad
/// Least difference of the cosines of a spot's cones, so that the light between them is defined.
constexpr float kHardEdge = 1e-4f;

Lighting default_lighting() {
  Lighting lighting;
  lighting.ambient = glm::vec3(kDefaultAmbient);
  Light key;
  key.kind = LightKind::kDirectional;
  key.color = glm::vec3(kDefaultKeyLight);
  key.direction = -glm::normalize(glm::vec3(2, 3, 1));
  lighting.lights.push_back(key);
  return lighting;
}

std::optional<LightKind> light_kind(const std::string& type) {
  if (type == "directional") return LightKind::kDirectional;
  if (type == "point") return LightKind::kPoint;
  if (type == "spot") return LightKind::kSpot;
  return std::nullopt;
}

/// Returns nullopt if a value is negative, not finite or beyond reason.
std::optional<Light> convert(const tinygltf::Light& source, const glm::dmat4& world) {
  Light light;
  const auto kind = light_kind(source.type);
  const glm::dvec3 direction = -glm::dvec3(world[2]);
  const double length = glm::length(direction);
  if (!kind || !is_finite(world)) return std::nullopt;
  light.kind = *kind;
  light.position = glm::dvec3(world[3]);
  if (length > 0 && std::isfinite(length)) light.direction = glm::vec3(direction / length);
  if (!(source.intensity >= 0) || source.intensity > kMaxIntensity) return std::nullopt;
  if (!(source.range >= 0)) return std::nullopt;
  for (std::size_t i = 0; i < 3; ++i) {
    const double channel = i < source.color.size() ? source.color[i] : 1.0;
    if (!(channel >= 0) || channel > kMaxIntensity) return std::nullopt;
    light.color[static_cast<int>(i)] =
        static_cast<float>(channel * source.intensity / glm::pi<double>());
  }
  light.range = static_cast<float>(std::min(source.range, 1e18));
  if (light.kind == LightKind::kSpot) {
    // Viewers clamp angles. Equal ones are a cone with a hard edge.
    const double outer =
        std::clamp(source.spot.outerConeAngle, kSmallestCone, glm::half_pi<double>());
    const double inner = std::clamp(source.spot.innerConeAngle, 0.0, outer);
    light.cos_outer = static_cast<float>(std::max(0.0, std::cos(outer)));
    light.cos_inner = std::max(static_cast<float>(std::cos(inner)), light.cos_outer + kHardEdge);
  }
  return light;
}

/// Returns the light on a surface in the middle that faces the light, in units of Light::color.
double brightness_at(const Light& light, const Bounds& bounds) {
  const double color = std::max({light.color.r, light.color.g, light.color.b});
  if (light.kind == LightKind::kDirectional) return color;
  const double distance =
      std::max(glm::length(light.position - bounds.center()), kNearestShare * bounds.radius());
  return distance > 0 ? color / (distance * distance) : color;
}

void expose(Lighting& lighting, const Bounds& bounds, Tally& tally) {
  double sum = 0;
  for (const Light& light : lighting.lights) sum += brightness_at(light, bounds);
  if (!(sum > kWellExposed) || !std::isfinite(sum)) return;
  const double exposure = kWellExposed / sum;
  for (Light& light : lighting.lights) light.color *= static_cast<float>(exposure);
  char line[80];
  std::snprintf(line, sizeof line, "lights are bright: all scaled by the exposure %.3g", exposure);
  tally.note(line);
}

/// Returns the index of the light of a node, -1 for none.
int light_of(const tinygltf::Node& node) {
  const auto found = node.extensions.find("KHR_lights_punctual");
  if (found == node.extensions.end() || !found->second.Has("light")) return -1;
  return found->second.Get("light").GetNumberAsInt();
}

}  // namespace

Lighting import_lighting(const Document& document, const NodeTree& tree, const Bounds& bounds,
                         Tally& tally, bool& own) {
  Lighting lighting;
  lighting.ambient = glm::vec3(kAmbientWithLights);
  for (const int node : tree.drawn) {
    const int index = light_of(document.model.nodes[node]);
    if (index < 0 || static_cast<std::size_t>(index) >= document.model.lights.size()) continue;
    if (lighting.lights.size() == kMaxLights) {
      tally.add("lights beyond the first 256 left out");
      continue;
    }
    const auto light = convert(document.model.lights[index], tree.world_from_node[node]);
    if (light) {
      lighting.lights.push_back(*light);
    } else {
      tally.add("lights with impossible values left out");
    }
  }
  own = !lighting.lights.empty();
  if (!own) return default_lighting();
  expose(lighting, bounds, tally);
  return lighting;
}

}  // namespace mirage::gltf
