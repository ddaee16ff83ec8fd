#include "server/bake/engine_texts.h"

#include <cstdio>
#include <cstring>

namespace mirage {

std::string EngineTextInput::file(const std::string& map) const {
  for (const auto& facts : maps) {
    if (facts.map == map) return facts.file.substr(facts.file.find_last_of('/') + 1);
  }
  return {};
}

glm::dvec3 EngineTextInput::center() const {
  return target.axes * master.center * target.units_per_meter;
}

double EngineTextInput::radius() const { return master.radius * target.units_per_meter; }

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value == 0 ? 0.0 : value);
  const bool whole = std::strpbrk(text, ".en") == nullptr;
  return whole ? std::string(text) + ".0" : text;
}

std::vector<BakeText> engine_texts(const BakeMaster& master, const TargetFacts& target,
                                   const std::string& name, const std::vector<BakeMapFacts>& maps) {
  const EngineTextInput in{master, target, name, maps};
  switch (target.texts) {
    case EngineText::kNone:
      return {};
    case EngineText::kThree:
      return {three_loader(in)};
    case EngineText::kGodot3:
      return {godot3_scene(in)};
    case EngineText::kGodot4:
      return {godot4_scene(in)};
    case EngineText::kUnity:
      return {unity_material(in)};
    case EngineText::kUnreal:
      return {unreal_script(in)};
  }
  return {};
}

}  // namespace mirage
