#include "server/bake/export.h"

#include <algorithm>

#include "server/bake/boimp_file.h"
#include "server/bake/encode.h"
#include "server/bake/engine_texts.h"
#include "server/bake/frame_texels.h"

namespace mirage {
namespace {

bool is_depth(MapChannel channel) {
  return channel == MapChannel::kDepthNear || channel == MapChannel::kDepthFar;
}

bool carries_depth(const TargetMap& map) {
  return std::any_of(map.channels.begin(), map.channels.end(), is_depth);
}

std::string file_of(std::string_view pattern, const std::string& name) {
  std::string out(pattern);
  return out.replace(out.find("NAME"), 4, name);
}

// Returns the file that brings a map: its own, or for depth one that has it in a channel.
const TargetMap* bringer(const TargetFacts& target, const std::string& map) {
  for (const auto& candidate : target.maps) {
    if (candidate.map == map) return &candidate;
  }
  for (const auto& candidate : target.maps) {
    if (map == "depth" && carries_depth(candidate)) return &candidate;
  }
  return nullptr;
}

Result<std::vector<const TargetMap*>> chosen_maps(const TargetFacts& target,
                                                  const ExportChoice& choice) {
  std::vector<const TargetMap*> out;
  if (choice.maps.empty()) {
    for (const auto& map : target.maps) {
      if (!map.on_request) out.push_back(&map);
    }
  }
  for (const auto& wanted : choice.maps) {
    if (target.packed) break;  // its one file has all maps
    const TargetMap* map = bringer(target, wanted);
    if (!map) {
      std::string known;
      for (const auto& m : target.maps) known += (known.empty() ? "" : ", ") + std::string(m.map);
      return make_error(ErrorId::kUsage,
                        "target " + std::string(target.name) + " reads no map " + wanted,
                        "it reads: " + known);
    }
    if (std::find(out.begin(), out.end(), map) == out.end()) out.push_back(map);
  }
  return out;
}

Result<void> check_master(const BakeMaster& master, const TargetFacts& target) {
  const auto fits = check_target(target, master.layout, master.grid, master.tile);
  if (!fits) return fits.error();
  const std::size_t texels = master.texels();
  if (master.color.size() != texels || master.normal.size() != texels ||
      master.depth.size() != texels || master.orm.size() != texels || !(master.radius > 0)) {
    return make_error(ErrorId::kInternal, "a capture without all its planes cannot be exported");
  }
  if (!rolled_alike(master.roll, target.roll, master.layout, master.grid)) {
    return make_error(ErrorId::kUsage, "target " + std::string(target.name) +
                                           " rolls the frames near the pole in another way than "
                                           "this capture");
  }
  return {};
}

BakeImage image_of(const BakeMaster& master, const TargetMap& map, const ExportChoice& choice) {
  BakeImage image;
  image.file = file_of(map.file, file_name_of(choice.object));
  image.map = map.map;
  image.width = image.height = master.grid * master.tile;
  image.channels = int(map.channels.size());
  image.srgb = map.srgb && !choice.linear;
  image.texels.resize(std::size_t(image.width) * image.height * image.channels);
  return image;
}

void write_texel(const FrameTexel& texel, const TargetFacts& target, const FrameBasis& basis,
                 const TargetMap& map, bool srgb, float* out) {
  for (const auto channel : map.channels) {
    const float value = encode(channel, texel, target, basis);
    *out++ = srgb && is_color(channel) ? srgb_of(value) : value;
  }
}

// Writes frame (i, j) of the consumer into each image.
void write_frame(const BakeMaster& master, const TargetFacts& target, int i, int j,
                 const std::vector<const TargetMap*>& maps, std::vector<BakeImage>& images) {
  const FrameOrder order =
      master.layout == BakeLayout::kHemi ? target.hemi_order : FrameOrder::kSame;
  const glm::ivec2 from = captured_frame(order, master.grid, i, j);
  const FrameTexels texels(master, target, master.first(from.x, from.y));
  const FrameBasis basis = master.basis(from.x, from.y);
  const int row = target.rows_from_bottom ? master.grid - 1 - j : j;
  for (int t = 0; t < master.tile * master.tile; ++t) {
    const FrameTexel texel = texels.at(t);
    const int x = t % master.tile;
    const int y = target.tiles_upside_down ? master.tile - 1 - t / master.tile : t / master.tile;
    const std::size_t at = std::size_t(row * master.tile + y) * master.grid * master.tile +
                           std::size_t(i) * master.tile + x;
    for (std::size_t m = 0; m < maps.size(); ++m) {
      BakeImage& image = images[m];
      write_texel(texel, target, basis, *maps[m], image.srgb, &image.texels[at * image.channels]);
    }
  }
}

BakeMapFacts facts_of(const TargetFacts& target, const TargetMap& map, const BakeImage& image) {
  BakeMapFacts facts;
  facts.map = map.map;
  facts.file = image.file;
  facts.color_space = image.srgb ? "srgb" : "linear";
  const bool colored = std::any_of(map.channels.begin(), map.channels.end(), is_color);
  facts.premultiplied = colored && target.premultiplied;
  facts.filled = colored ? target.color_fill : target.geometry_fill;
  facts.background.resize(map.channels.size());
  write_texel(empty_texel(), target, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, map, image.srgb,
              facts.background.data());
  constexpr const char* kNames = "rgba";
  for (std::size_t c = 0; c < map.channels.size(); ++c) {
    facts.channels.emplace_back(formula_of(map.channels[c]));
    if (!is_depth(map.channels[c])) continue;
    const std::string value = map.channels.size() == 1 ? "value" : std::string(1, kNames[c]);
    facts.depth = map.channels[c] == MapChannel::kDepthNear
                      ? "s = (" + value + " - .5) * 2 * radius"
                      : "s = (.5 - " + value + ") * 2 * radius";
  }
  return facts;
}

Result<BakeExport> export_packed(const BakeMaster& master, const TargetFacts& target,
                                 const ExportChoice& choice) {
  auto bytes = boimp_file(master, target);
  if (!bytes) return bytes.error();
  BakeExport out;
  out.binaries.push_back({file_name_of(choice.object) + ".boimp", bytes.take()});
  out.maps.push_back({.map = "all",
                      .file = out.binaries.back().file,
                      .color_space = "linear",
                      .channels = boimp_channels(),
                      .depth = "s = (value - .5) * 2 * radius",
                      .background = std::vector<float>(boimp_channels().size(), 0.0f)});
  return out;
}

}  // namespace

std::string file_name_of(const std::string& object) {
  constexpr std::size_t kLongest = 64;
  std::string out;
  for (const char c : object.substr(0, kLongest)) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '_';
    out += plain ? c : '_';
  }
  return out.empty() ? "object" : out;
}

Result<BakeExport> export_bake(const BakeMaster& master, const TargetFacts& target,
                               const ExportChoice& choice) {
  if (const auto fits = check_master(master, target); !fits) return fits.error();
  const auto maps = chosen_maps(target, choice);
  if (!maps) return maps.error();
  if (target.packed) return export_packed(master, target, choice);
  BakeExport out;
  for (const TargetMap* map : *maps) out.images.push_back(image_of(master, *map, choice));
  for (int j = 0; j < master.grid; ++j) {
    for (int i = 0; i < master.grid; ++i) write_frame(master, target, i, j, *maps, out.images);
  }
  for (std::size_t m = 0; m < maps->size(); ++m) {
    out.maps.push_back(facts_of(target, *(*maps)[m], out.images[m]));
  }
  out.texts = engine_texts(master, target, file_name_of(choice.object), out.maps);
  return out;
}

}  // namespace mirage
