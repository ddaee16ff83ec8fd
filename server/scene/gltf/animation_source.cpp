#include "server/scene/gltf/animation_source.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "server/scene/gltf/extras.h"
#include "server/scene/gltf/gltf_limits.h"

namespace mirage::gltf {
namespace {

using nlohmann::json;

std::size_t entry_count(const json& root, const char* key) {
  const json* list = member(root, key);
  return list != nullptr && list->is_array() ? list->size() : 0;
}

/// Returns a whole number below `size`, else -1.
int index_below(const json* value, std::size_t size) {
  if (value == nullptr || !value->is_number()) return -1;
  const double number = value->get<double>();
  const bool fits = number >= 0 && number < static_cast<double>(size);
  return fits && number == std::floor(number) ? static_cast<int>(number) : -1;
}

std::string text(const json* value, std::string fallback) {
  return value != nullptr && value->is_string() ? value->get<std::string>() : fallback;
}

/// Reads a target by KHR_animation_pointer, as far as it is a property of a node. Returns false for
/// others.
bool read_pointer(const json& target, std::size_t nodes, ChannelSource& out) {
  const json* extensions = member(target, "extensions");
  const json* extension =
      extensions != nullptr ? member(*extensions, "KHR_animation_pointer") : nullptr;
  const std::string pointer =
      text(extension != nullptr ? member(*extension, "pointer") : nullptr, "");
  constexpr std::string_view kNodes = "/nodes/";
  if (!pointer.starts_with(kNodes)) return false;
  const std::size_t slash = std::min(pointer.find('/', kNodes.size()), pointer.size());
  std::size_t node = 0;
  const auto [end, error] =
      std::from_chars(pointer.data() + kNodes.size(), pointer.data() + slash, node);
  if (error != std::errc() || end != pointer.data() + slash || node >= nodes) return false;
  const std::string_view property = std::string_view(pointer).substr(slash);
  out.node = static_cast<int>(node);
  out.path = property == "/extensions/KHR_node_visibility/visible"
                 ? kVisiblePath
                 : std::string(property.substr(std::min<std::size_t>(1, property.size())));
  return true;
}

bool read_channel(const json& channel, const json& samplers, const json& root, ChannelSource& out) {
  const int sampler = index_below(member(channel, "sampler"), samplers.size());
  const json* target = member(channel, "target");
  if (sampler < 0 || target == nullptr) return false;
  const json& source = samplers[static_cast<std::size_t>(sampler)];
  out.node = index_below(member(*target, "node"), entry_count(root, "nodes"));
  out.path = text(member(*target, "path"), "");
  if (out.path == "pointer") read_pointer(*target, entry_count(root, "nodes"), out);
  out.input = index_below(member(source, "input"), entry_count(root, "accessors"));
  out.output = index_below(member(source, "output"), entry_count(root, "accessors"));
  out.interpolation = text(member(source, "interpolation"), "LINEAR");
  return out.node >= 0 && out.input >= 0 && out.output >= 0;
}

AnimationSource read_clip(const json& entry, const json& root, Tally& tally) {
  AnimationSource clip;
  clip.name = text(member(entry, "name"), "");
  const json* channels = member(entry, "channels");
  const json* samplers = member(entry, "samplers");
  if (channels == nullptr || samplers == nullptr || !channels->is_array() ||
      !samplers->is_array() || channels->size() > kMaxChannelsInFile) {
    tally.add("animations that are malformed or too large ignored");
    return clip;
  }
  for (const json& channel : *channels) {
    ChannelSource source;
    if (read_channel(channel, *samplers, root, source)) {
      clip.channels.push_back(std::move(source));
    } else {
      tally.add("animation channels without an existing target and sampler ignored");
    }
  }
  return clip;
}

}  // namespace

AnimationSources read_animations(const json& root, Tally& tally) {
  AnimationSources out;
  if (const json* list = member(root, "animations"); list != nullptr && list->is_array()) {
    if (list->size() > kMaxClips) tally.add("files with too many animations: some ignored");
    for (std::size_t i = 0; i < std::min(list->size(), kMaxClips); ++i) {
      out.clips.push_back(read_clip((*list)[i], root, tally));
    }
  }
  const json* nodes = member(root, "nodes");
  if (nodes == nullptr || !nodes->is_array()) return out;
  for (std::size_t i = 0; i < nodes->size(); ++i) {
    const json* phase = mirage_extra((*nodes)[i], "phase");
    if (phase == nullptr || !phase->is_number()) continue;
    const double offset = phase->get<double>();
    if (std::abs(offset) <= kMaxClipOffset) out.clip_offset_s[static_cast<int>(i)] = offset;
  }
  return out;
}

}  // namespace mirage::gltf
