#pragma once
// The files beside the pictures that save work in an engine: scenes for Godot, material values for
// Unity, an import script for Unreal, a loader for three.js. Files: engine_texts.cpp chooses,
// godot_scene.cpp and editor_texts.cpp write.

#include <string>
#include <vector>

#include "server/bake/export.h"

namespace mirage {

/// `name`: file_name_of() of the object, so that it needs no quoting in any of them.
struct EngineTextInput {
  const BakeMaster& master;
  const TargetFacts& target;
  const std::string& name;
  const std::vector<BakeMapFacts>& maps;

  /// Returns the file of a map without its folder, or an empty name.
  std::string file(const std::string& map) const;
  /// Returns the centre in the consumer's axes and units.
  glm::dvec3 center() const;
  double radius() const;
};

std::vector<BakeText> engine_texts(const BakeMaster& master, const TargetFacts& target,
                                   const std::string& name, const std::vector<BakeMapFacts>& maps);

BakeText godot3_scene(const EngineTextInput& in);
BakeText godot4_scene(const EngineTextInput& in);
BakeText unity_material(const EngineTextInput& in);
BakeText unreal_script(const EngineTextInput& in);
BakeText three_loader(const EngineTextInput& in);

/// Returns a number as all these languages read it: shortest form that keeps a float.
std::string number(double value);

}  // namespace mirage
