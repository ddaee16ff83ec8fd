#pragma once
// Procedural, seeded scenes: `builtin:NAME[?key=value&…]`.

#include <string>
#include <vector>

#include "server/base/load_tools.h"
#include "server/scene/scene.h"

namespace mirage {

struct BuiltinSceneInfo {
  std::string name;
  std::string description;
  std::string options;  ///< e.g. "trees=400 species=4 seed=1"
};
const std::vector<BuiltinSceneInfo>& builtin_scenes();

/// Builds the scene named by `spec` (without the `builtin:` prefix), e.g. "forest?trees=50&seed=7".
/// The same spec gives the same bytes for any number of threads. Error kSceneBuiltin: an unknown
/// name or option, or a value out of range; it names the allowed ones.
Result<Scene> build_builtin_scene(const std::string& spec, const LoadTools& tools = {Workers()});

}  // namespace mirage
