#pragma once
// Reads a file's animations from the JSON, leniently: a broken animation leaves its object at rest
// and never refuses the scene.

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// Path of a channel that shows and hides a node with its children: KHR_animation_pointer to the
/// `visible` of KHR_node_visibility.
inline constexpr const char* kVisiblePath = "visible";

struct ChannelSource {
  int node = -1;   ///< exists
  int input = -1;  ///< accessors, exist
  int output = -1;
  std::string path;  ///< as glTF names it, or kVisiblePath
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
