#pragma once
// Turns the clips of a file into checked keys per node. Constant channels become the node's rest
// pose.

#include <map>
#include <vector>

#include "protocol/model/animation.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// The animation of one node; `target` of the channels is not set yet.
struct NodeClip {
  float clip_s = 0;
  std::vector<Channel> channels;  ///< translation, rotation, scale, at most one each
  std::vector<Channel> weights;   ///< at most one
};

/// Merges all clips; a property keeps the keys of the first clip that moves it. Clips of different
/// objects therefore all play; of several clips of one character, only the first does. Channels
/// that break the rules of glTF are ignored with a warning. Channels with only equal keys are
/// written into the node's own transform and weights.
std::map<int, NodeClip> import_clips(Document& document, Tally& tally);

/// Returns what the clips of the file are called: by their names, or by their places from 0 where a
/// name is missing, too long or taken. Clips that move nothing that can be read are left out.
std::vector<std::string> clip_names(const Document& document);

/// Keeps one clip of the file, by name or by its place from 0; all of them if `clip` is empty.
/// Returns what it is called. Error kUsage: no such clip; the hint lists them.
Result<std::string> choose_clip(const std::string& clip, Document& document);

}  // namespace mirage::gltf
