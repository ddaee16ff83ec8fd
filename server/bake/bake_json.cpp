#include "server/bake/bake_json.h"

#include <spdlog/fmt/fmt.h>
#include <xxhash.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace mirage {
namespace {

using nlohmann::ordered_json;

constexpr const char* kObjectFormat = "mirage-bake 1";
constexpr const char* kIndexFormat = "mirage-bake index 1";

std::string hex(std::uint64_t v) { return fmt::format("{:016x}", v); }

// Rounds to 1 / `steps`.
ordered_json rounded_to(const std::optional<double>& v, double steps) {
  if (!v || !std::isfinite(*v)) return nullptr;
  return std::round(*v * steps) / steps;
}

ordered_json vector(const glm::dvec3& v) { return ordered_json::array({v.x, v.y, v.z}); }

ordered_json matrix(const glm::dmat3& m) {
  ordered_json rows = ordered_json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({m[0][r], m[1][r], m[2][r]});
  return rows;
}

ordered_json map_json(const BakeMapFacts& map, BakeFormat format) {
  return {{"map", map.map},
          {"file", map.file},
          {"color_space", map.color_space},
          {"premultiplied", map.premultiplied},
          {"channels", map.channels},
          {"depth", map.depth},
          {"background", map.background},
          {"filled_texels", map.filled},
          {"bits", format == BakeFormat::kPng     ? 8
                   : format == BakeFormat::kPng16 ? 16
                                                  : 32}};
}

ordered_json file_json(const BakedFile& file) {
  return {{"name", file.name}, {"bytes", file.bytes}, {"xxh3", hex(file.hash)}};
}

ordered_json error_json(const std::vector<BakeErrorRow>& rows) {
  ordered_json out = ordered_json::array();
  for (const BakeErrorRow& row : rows) {
    out.push_back({{"method", name_of(row.method)},
                   {"distance_r", row.radii},
                   {"nearest_frame_deg", rounded_to(row.angle_deg, 100)},
                   {"psnr_db", rounded_to(row.psnr_db, 100)},
                   {"ssim", rounded_to(row.ssim, 1e4)},
                   {"iou", rounded_to(row.iou, 1e4)}});
  }
  return out;
}

ordered_json checked_against(const TargetFacts& target) {
  if (target.source.empty()) return nullptr;
  return {{"source", target.source}, {"commit", target.commit}};
}

std::string dumped(const ordered_json& json) {
  return json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string formula(BakeLayout layout) {
  switch (layout) {
    case BakeLayout::kHemi:
      return "u = i/(grid-1), v = j/(grid-1); x = u-v, z = u+v-1, y = 1-|x|-|z|; normalised";
    case BakeLayout::kOctahedral:
      return "p = 2i/(grid-1)-1, q = 2j/(grid-1)-1, y = 1-|p|-|q|; where y < 0: x = sgn p (1-|q|), "
             "z = sgn q (1-|p|), else x = p, z = q; normalised";
    case BakeLayout::kRing:
      return "a = 2 pi (j*grid+i) / grid^2; (sin a, 0, cos a)";
  }
  return "";
}

}  // namespace

std::string run_hash(const BakeOptions& o, std::uint64_t revision) {
  std::string all = fmt::format("{} {} {} {} {} {} {} {} {} {}", MIRAGE_VERSION, revision,
                                o.target->name, name_of(o.layout), o.grid, o.size, o.samples,
                                int(o.format), int(o.measure), o.error_db.value_or(0));
  all += o.whole ? " whole" : "";
  for (const std::string& name : o.objects) all += " o:" + name;
  for (const std::string& map : o.maps) all += " m:" + map;
  return hex(XXH3_64bits(all.data(), all.size()));
}

std::string object_json(const BakedObject& object, const BakeOptions& o, const std::string& run) {
  const TargetFacts& target = *o.target;
  const BakeShot& shot = object.shot;
  ordered_json maps = ordered_json::array(), files = ordered_json::array();
  for (const BakeMapFacts& map : object.maps) maps.push_back(map_json(map, o.format));
  for (const BakedFile& file : object.files) files.push_back(file_json(file));
  const double unit = target.units_per_meter;
  return dumped({{"format", kObjectFormat},
                 {"run", run},
                 {"object", object.name},
                 {"triangles", object.triangles},
                 {"target", target.name},
                 {"consumer", target.consumer},
                 {"checked_against", checked_against(target)},
                 {"layout", name_of(shot.layout)},
                 {"direction_of_frame", formula(shot.layout)},
                 {"grid", shot.grid},
                 {"tile_px", shot.tile},
                 {"size_px", shot.grid * shot.tile},
                 {"row_origin", target.rows_from_bottom ? "bottom" : "top"},
                 {"tiles_upside_down", target.tiles_upside_down},
                 {"gutter_px", 0},
                 {"margin_px", target.margin},
                 {"samples", shot.samples * shot.samples},
                 {"axes_from_gltf", matrix(target.axes)},
                 {"units_per_meter", unit},
                 {"center", vector(target.axes * shot.center * unit)},
                 {"radius", shot.radius * unit},
                 {"extent", vector(glm::abs(target.axes * object.extent) * unit)},
                 {"depth_range", {-shot.radius * unit, shot.radius * unit}},
                 {"maps", maps},
                 {"files", files},
                 {"texture_bytes", object.maps.size() * 4 * std::uint64_t(shot.grid) * shot.grid *
                                       shot.tile * shot.tile},
                 {"error", error_json(object.error)},
                 {"warnings", object.warnings}});
}

std::optional<ObjectEntry> read_object_json(const std::string& text) {
  const ordered_json json = ordered_json::parse(text, nullptr, false);
  if (!json.is_object() || json.value("format", ordered_json()) != kObjectFormat) {
    return std::nullopt;
  }
  ObjectEntry out;
  out.text = text;
  if (!json.contains("run") || !json["run"].is_string()) return std::nullopt;
  out.run = json["run"].get<std::string>();
  for (const ordered_json& file : json.value("files", ordered_json::array())) {
    if (!file.is_object() || !file.value("name", ordered_json()).is_string() ||
        !file.value("bytes", ordered_json()).is_number_unsigned() ||
        !file.value("xxh3", ordered_json()).is_string()) {
      return std::nullopt;
    }
    const std::string hash = file["xxh3"].get<std::string>();
    out.files.push_back({file["name"].get<std::string>(), file["bytes"].get<std::uint64_t>(),
                         std::strtoull(hash.c_str(), nullptr, 16)});
  }
  return out;
}

std::string index_json(const std::vector<ObjectEntry>& objects,
                       const std::vector<std::string>& missing, const BakeOptions& options,
                       const std::string& run) {
  ordered_json list = ordered_json::array();
  std::uint64_t bytes = 0;
  for (const ObjectEntry& entry : objects) {
    const ordered_json json = ordered_json::parse(entry.text);
    ordered_json row;
    for (const char* key : {"object", "triangles", "layout", "grid", "tile_px", "center", "radius",
                            "texture_bytes", "files", "error", "warnings"}) {
      row[key] = json.value(key, ordered_json());
    }
    for (const BakedFile& file : entry.files) bytes += file.bytes;
    list.push_back(std::move(row));
  }
  return dumped({{"format", kIndexFormat},
                 {"run", run},
                 {"target", options.target->name},
                 {"bytes", bytes},
                 {"objects", list},
                 {"missing", missing}});
}

}  // namespace mirage
