#include "client/host/light_script.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include "protocol/impostor/lighting_state.h"

namespace mirage {
namespace {
constexpr double kSunDegreesPerSecond = 15;
constexpr double kDegree = 0.017453292519943295;
}  // namespace

Result<LightScript> LightScript::create(const std::string& spec) {
  LightScript script;
  if (spec == "builtin:fixed") return script;
  if (spec == "builtin:sun-sweep") {
    script.kind_ = Kind::kSunSweep;
    return script;
  }
  if (spec == "builtin:lamp-toggle") {
    script.kind_ = Kind::kLampToggle;
    return script;
  }
  if (spec.rfind("builtin:", 0) == 0) {
    return make_error(ErrorId::kUsage, "unknown light '" + spec + "'",
                      "builtin:fixed, sun-sweep or lamp-toggle");
  }
  std::ifstream file(spec);
  if (!file) return make_error(ErrorId::kIo, "cannot read light file '" + spec + "'");
  script.kind_ = Kind::kFile;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream in(line);
    double v[10];
    bool ok = true;
    for (double& value : v) ok = ok && static_cast<bool>(in >> value);
    Lighting lighting;
    lighting.ambient = glm::vec3(v[1], v[2], v[3]);
    Light sun;
    sun.color = glm::vec3(v[4], v[5], v[6]);
    sun.direction = glm::vec3(v[7], v[8], v[9]);
    lighting.lights.push_back(sun);
    Result<Lighting> checked = checked_lighting(lighting);
    if (!ok || !checked) {
      return make_error(ErrorId::kUsage, spec + ":" + std::to_string(number) + ": no lighting line",
                        "t_ms, ambient r g b, sun r g b, direction x y z");
    }
    script.keys_.push_back({v[0] / 1000.0, checked.take()});
  }
  if (script.keys_.empty()) return make_error(ErrorId::kUsage, "light file has no lines");
  return script;
}

std::optional<Lighting> LightScript::at(double seconds, const Lighting& scene) const {
  if (kind_ == Kind::kFixed) return std::nullopt;
  if (kind_ == Kind::kFile) {
    const Key* now = &keys_.front();
    for (const Key& key : keys_) {
      if (key.seconds <= seconds) now = &key;
    }
    return now->lighting;
  }
  Lighting out = scene;
  if (kind_ == Kind::kLampToggle) {
    const bool on = std::fmod(seconds, 2.0) < 1.0;
    if (!on && !out.lights.empty()) out.lights.back().color = glm::vec3(0);
    return out;
  }
  const double angle = seconds * kSunDegreesPerSecond * kDegree;
  const double c = std::cos(angle), s = std::sin(angle);
  for (Light& light : out.lights) {
    if (light.kind != LightKind::kDirectional) continue;
    const glm::dvec3 d(light.direction);
    light.direction = glm::vec3(c * d.x + s * d.z, d.y, -s * d.x + c * d.z);
  }
  return out;
}

}  // namespace mirage
