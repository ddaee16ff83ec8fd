#include "server/scene/gltf/clip_import.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>

#include "protocol/base/limits.h"
#include "server/scene/gltf/accessor_reader.h"
#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/name_list.h"

namespace mirage::gltf {
namespace {

constexpr std::string_view kLaterClips =
    "clips that ?clip=NAME plays left out, since an earlier one moves the same parts";
constexpr float kEqualKeys = 1e-7f;  // relative: rounding of one value written many times

std::optional<ChannelPath> path_of(const std::string& name) {
  if (name == "translation") return ChannelPath::kTranslation;
  if (name == "rotation") return ChannelPath::kRotation;
  if (name == "scale") return ChannelPath::kScale;
  if (name == "weights") return ChannelPath::kWeights;
  if (name == kVisiblePath) return ChannelPath::kScale;
  return std::nullopt;
}

std::optional<Interpolation> interpolation_of(const std::string& name) {
  if (name == "STEP") return Interpolation::kStep;
  if (name == "LINEAR") return Interpolation::kLinear;
  if (name == "CUBICSPLINE") return Interpolation::kCubicSpline;
  return std::nullopt;
}

std::size_t morph_targets(const tinygltf::Model& model, const tinygltf::Node& node) {
  std::size_t most = 0;
  if (node.mesh < 0) return most;
  for (const auto& primitive : model.meshes[node.mesh].primitives) {
    most = std::max(most, primitive.targets.size());
  }
  return most;
}

std::size_t width_of(ChannelPath path, const tinygltf::Model& model, const tinygltf::Node& node) {
  if (path == ChannelPath::kWeights) return morph_targets(model, node);
  return path == ChannelPath::kRotation ? 4 : 3;
}

bool good_times(const std::vector<float>& times) {
  float last = -1;
  for (const float t : times) {
    if (!(t >= 0) || !(t > last) || t > static_cast<float>(limits::kMaxClipSeconds)) return false;
    last = t;
  }
  return !times.empty();
}

bool good_values(const Channel& c, std::size_t width) {
  const std::size_t stride = width * (c.interpolation == Interpolation::kCubicSpline ? 3 : 1);
  if (width == 0 || c.values.size() != c.times.size() * stride) return false;
  for (const float v : c.values) {
    if (!(std::abs(v) <= kMaxCoordinate)) return false;  // false for NaN
  }
  if (c.path != ChannelPath::kRotation) return true;
  const std::size_t first = c.interpolation == Interpolation::kCubicSpline ? 4 : 0;
  for (std::size_t at = first; at < c.values.size(); at += stride) {
    const float* q = &c.values[at];
    if (q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0) return false;
  }
  return true;
}

/// Accessors with absurd sizes are not even read.
bool affordable(const tinygltf::Model& model, const ChannelSource& source) {
  return model.accessors[source.input].count <= limits::kMaxAnimationFloats &&
         model.accessors[source.output].count <= limits::kMaxAnimationFloats;
}

/// Returns what shows and hides a node: its scale, and 0.
std::vector<float> scales_of(const std::vector<float>& visible, const tinygltf::Node& node) {
  std::vector<float> scales;
  for (const float shown : visible) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double scale = node.scale.size() == 3 ? node.scale[c] : 1.0;
      scales.push_back(shown != 0 ? static_cast<float>(scale) : 0.0f);
    }
  }
  return scales;
}

std::optional<Channel> read_channel(const Document& document, const ChannelSource& source) {
  const tinygltf::Node& node = document.model.nodes[source.node];
  const auto path = path_of(source.path);
  const auto interpolation = interpolation_of(source.interpolation);
  if (!path || !interpolation || !affordable(document.model, source)) return std::nullopt;
  // glTF section 3.11 forbids animating a node that has a matrix.
  if (*path != ChannelPath::kWeights && node.matrix.size() == 16) return std::nullopt;
  const bool shows = source.path == kVisiblePath;
  const std::size_t width = shows ? 1 : width_of(*path, document.model, node);
  auto times = read_floats(document, source.input, 1);
  auto values = read_floats(document, source.output, *path == ChannelPath::kWeights ? 1 : width);
  if (!times || !values) return std::nullopt;
  Channel channel;
  channel.path = *path;
  channel.interpolation = *interpolation;
  channel.times = times.take();
  channel.values = shows ? scales_of(values.take(), node) : values.take();
  if (shows) channel.interpolation = Interpolation::kStep;
  if (!good_times(channel.times) || !good_values(channel, shows ? 3 : width)) return std::nullopt;
  return channel;
}

bool equal_keys(const Channel& c, std::size_t width) {
  const bool cubic = c.interpolation == Interpolation::kCubicSpline;
  const std::size_t stride = width * (cubic ? 3 : 1), first = cubic ? width : 0;
  for (std::size_t key = 0; key < c.times.size(); ++key) {
    for (std::size_t i = 0; i < width; ++i) {
      const float* at = &c.values[key * stride];
      const float here = at[first + i], there = c.values[first + i];
      if (std::abs(here - there) > kEqualKeys * std::max(1.0f, std::abs(there))) return false;
      if (cubic && c.times.size() > 1 && (at[i] != 0 || at[2 * width + i] != 0)) return false;
    }
  }
  return true;
}

/// Writes the value shared by all keys into the node's rest pose.
void write_rest(const Channel& c, std::size_t width, tinygltf::Node& node) {
  std::vector<double> value(width);
  sample_channel(c, 0, width, value.data());
  switch (c.path) {
    case ChannelPath::kTranslation:
      node.translation = value;
      break;
    case ChannelPath::kRotation:
      node.rotation = value;
      break;
    case ChannelPath::kScale:
      node.scale = value;
      break;
    case ChannelPath::kWeights:
      node.weights = value;
      break;
  }
}

/// The channels of a clip that can be read, with their nodes.
using NodeChannels = std::vector<std::pair<int, Channel>>;

/// True if no channel of the clip changes anything.
bool is_pose(const NodeChannels& channels, float clip_s, const tinygltf::Model& model) {
  return !(clip_s > 0) || std::all_of(channels.begin(), channels.end(), [&](const auto& entry) {
    const auto& [node, channel] = entry;
    return equal_keys(channel, width_of(channel.path, model, model.nodes[node]));
  });
}

/// A node whose scale shows and hides it counts as shown itself.
void show(tinygltf::Node& node) { node.extensions.erase("KHR_node_visibility"); }

/// Returns the place of the first clip of this name; the number of clips: there is none.
std::size_t place_of(const std::string& name, const std::vector<AnimationSource>& clips) {
  const auto found = std::find_if(clips.begin(), clips.end(), [&](const AnimationSource& source) {
    return source.name == name;
  });
  return static_cast<std::size_t>(found - clips.begin());
}

/// Returns what a clip is called: by its name, or by its place from 0.
std::string called(const std::vector<AnimationSource>& clips, std::size_t place) {
  const std::string& name = clips[place].name;
  const bool its_own =
      !name.empty() && name.size() <= limits::kMaxChoiceBytes && place_of(name, clips) == place;
  return its_own ? name : std::to_string(place);
}

}  // namespace

std::map<int, NodeClip> import_clips(Document& document, Tally& tally) {
  std::map<int, NodeClip> out;
  std::set<std::pair<int, ChannelPath>> taken;
  std::vector<NodeChannels> poses;
  std::size_t floats = 0;
  for (const AnimationSource& clip : document.animations.clips) {
    NodeChannels channels;
    float clip_s = 0;
    for (const ChannelSource& source : clip.channels) {
      auto channel = read_channel(document, source);
      if (!channel) {
        tally.add("animation channels with unusable keys ignored");
        continue;
      }
      floats += channel->times.size() + channel->values.size();
      if (floats > limits::kMaxAnimationFloats) {
        tally.add("animation channels beyond the limit of keys ignored");
        continue;
      }
      if (source.path == kVisiblePath) show(document.model.nodes[source.node]);
      clip_s = std::max(clip_s, channel->times.back());
      channels.emplace_back(source.node, std::move(*channel));
    }
    // A pose is for what no clip moves, whichever comes first in the file.
    if (is_pose(channels, clip_s, document.model)) {
      poses.push_back(std::move(channels));
      continue;
    }
    const bool seen = std::any_of(channels.begin(), channels.end(), [&](const auto& entry) {
      return taken.count({entry.first, entry.second.path}) != 0;
    });
    if (seen) {
      tally.add(kLaterClips, 1, clip.name);
      continue;
    }
    for (auto& [node, channel] : channels) {
      if (!taken.insert({node, channel.path}).second) {
        tally.add("animation channels of one property twice ignored");
        continue;
      }
      const std::size_t width = width_of(channel.path, document.model, document.model.nodes[node]);
      if (equal_keys(channel, width)) {
        write_rest(channel, width, document.model.nodes[node]);
        continue;
      }
      NodeClip& moved = out[node];
      moved.clip_s = std::max(moved.clip_s, clip_s);
      auto& list = channel.path == ChannelPath::kWeights ? moved.weights : moved.channels;
      list.push_back(std::move(channel));
    }
  }
  for (const NodeChannels& pose : poses) {
    for (const auto& [node, channel] : pose) {
      if (!taken.insert({node, channel.path}).second) continue;
      tinygltf::Node& target = document.model.nodes[node];
      write_rest(channel, width_of(channel.path, document.model, target), target);
    }
  }
  return out;
}

std::vector<std::string> clip_names(const Document& document) {
  std::vector<std::string> out;
  const std::vector<AnimationSource>& clips = document.animations.clips;
  for (std::size_t i = 0; i < clips.size() && out.size() < limits::kMaxChoices; ++i) {
    if (!clips[i].channels.empty()) out.push_back(called(clips, i));
  }
  return out;
}

Result<std::string> choose_clip(const std::string& clip, Document& document) {
  if (clip.empty()) return std::string();
  std::vector<AnimationSource>& clips = document.animations.clips;
  std::size_t found = place_of(clip, clips);
  const bool digits = clip.size() < 6 && clip.find_first_not_of("0123456789") == std::string::npos;
  if (found == clips.size() && digits) {
    found = std::min(clips.size(), static_cast<std::size_t>(std::stoi(clip)));
  }
  if (found == clips.size()) {
    std::vector<std::string> names;
    for (const AnimationSource& source : clips) names.push_back(source.name);
    return make_error(ErrorId::kUsage, "no clip '" + shown_name(clip) + "'",
                      listed_names("clips", names));
  }
  const std::string name = called(clips, found);
  clips = {std::move(clips[found])};
  return name;
}

}  // namespace mirage::gltf
