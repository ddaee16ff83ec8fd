#pragma once
// The clips of a file -> keys per node, checked. Constant channels become the node's rest pose.

#include <map>
#include <vector>

#include "protocol/model/animation.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// What moves one node; `target` of the channels is not set yet.
struct NodeClip {
  float clip_s = 0;
  std::vector<Channel> channels;  ///< translation, rotation, scale, at most one each
  std::vector<Channel> weights;   ///< at most one
};

/// All clips together, as far as no earlier clip of the file moves the same property: clips of
/// different objects all play, of several clips of one character the first does. Channels that
/// break the rules of glTF are ignored, with a warning; those whose keys are all equal are written
/// into the node's own transform and weights.
std::map<int, NodeClip> import_clips(Document& document, Tally& tally);

}  // namespace mirage::gltf
