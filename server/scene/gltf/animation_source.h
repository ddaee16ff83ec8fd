#pragma once
// Reads a file's animations from the JSON, leniently: a broken animation leaves its object at rest
// and never refuses the scene.

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

struct ChannelSource {
  int node = -1;   ///< exists
  int input = -1;  ///< accessors, exist
  int output = -1;
  std::string path;
  std::string interpolation = "LINEAR";
};

/// The channels of one clip whose references are valid.
struct AnimationSource {
  std::string name;
  std::vector<ChannelSource> channels;
};

struct AnimationSources {
  std::vector<AnimationSource> clips;
  std::map<int, double> clip_offset_s;  ///< node -> extras.mirage.phase, finite
};

AnimationSources read_animations(const nlohmann::json& root, Tally& tally);

}  // namespace mirage::gltf
