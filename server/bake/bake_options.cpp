#include "server/bake/bake_options.h"

#include <cmath>

#include "protocol/base/cli.h"

namespace mirage {
namespace {

constexpr int kLargestSize = 8192;  // texels; what graphics cards of ten years take

/// Values as the command line has them.
struct Given {
  std::string target = "generic", layout, maps, format = "png", measure = "quick", shard = "1/1";
  std::optional<int> grid, size;
};

std::string target_names() {
  std::string out;
  for (const TargetFacts& target : bake_targets()) {
    out += (out.empty() ? "" : "|") + std::string(target.name);
  }
  return out;
}

std::vector<std::string> words(const std::string& list) {
  std::vector<std::string> out(1);
  for (const char c : list) {
    if (c == ',') {
      out.emplace_back();
    } else {
      out.back() += c;
    }
  }
  return out;
}

Error usage(const std::string& text, const std::string& hint) {
  return make_error(ErrorId::kUsage, text, hint);
}

Result<void> check_names(const Given& given, BakeOptions& o) {
  o.target = target_of(given.target);
  if (!o.target) return usage("no target is called '" + given.target + "'", target_names());
  o.layout = o.target->layouts.front();
  if (!given.layout.empty()) {
    const std::optional<BakeLayout> layout = layout_of(given.layout);
    if (!layout) return usage("no layout is called '" + given.layout + "'", "hemi|octahedral|ring");
    o.layout = *layout;
  }
  if (!given.maps.empty()) o.maps = words(given.maps);
  for (const std::string& map : o.maps) {
    if (map != "color" && map != "normal" && map != "depth" && map != "orm") {
      return usage("no map is called '" + map + "'", "color,normal,depth,orm");
    }
  }
  const std::pair<const char*, BakeFormat> formats[] = {
      {"png", BakeFormat::kPng}, {"png16", BakeFormat::kPng16}, {"exr", BakeFormat::kExr}};
  bool known = false;
  for (const auto& [name, format] : formats) {
    if (given.format != name) continue;
    o.format = format;
    known = true;
  }
  if (!known) return usage("no format is called '" + given.format + "'", "png|png16|exr");
  return {};
}

Result<void> check_numbers(const Given& given, BakeOptions& o) {
  o.grid = given.grid.value_or(o.target->grid);
  o.size = given.size.value_or(o.target->grid * o.target->tile);
  if (o.grid < kFewestFrames || o.grid > kMostFrames) {
    return usage("--grid " + std::to_string(o.grid) + " is outside 2 to 64",
                 "12 and 16 are usual; each step costs 2 * grid frames");
  }
  const int tile = o.size / o.grid;
  if (o.size > kLargestSize || tile < 8) {
    return usage("--size " + std::to_string(o.size) + " leaves frames of " + std::to_string(tile) +
                     " texels",
                 "a frame has at least 8 texels, and the picture at most 8192");
  }
  if (o.error_db && !(std::isfinite(*o.error_db) && *o.error_db >= 5 && *o.error_db <= 60)) {
    return usage("--error is outside 5 to 60 dB", "25 is good, 30 is hardly seen");
  }
  if (o.error_db && o.layout == BakeLayout::kRing) {
    return usage("--error cannot be met by a ring", "it has no frames from above");
  }
  return {};
}

Result<void> check(const Given& given, BakeOptions& o) {
  if (Result<void> names = check_names(given, o); !names) return names;
  const Result<Shard> shard = parse_shard(given.shard);
  if (!shard) return shard.error();
  o.shard = *shard;
  if (Result<void> numbers = check_numbers(given, o); !numbers) return numbers;
  if (given.measure == "none") o.measure = MeasureChoice::kNone;
  if (given.measure == "full") o.measure = MeasureChoice::kFull;
  if (o.whole && !o.objects.empty()) {
    return usage("--whole and --object exclude each other", "--whole bakes all objects as one");
  }
  if (o.out.empty() && !o.dry_run) return usage("--out DIR is missing", "or --dry-run");
  return {};
}

void add_picture_options(CLI::App& app, BakeOptions& o, Given& given) {
  app.option_defaults()->group("Picture");
  app.add_option("--target", given.target, "who reads the bake: " + target_names())
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--layout", given.layout,
                 "directions: hemi (from above), octahedral (all around) or ring; default: the "
                 "target's")
      ->type_name("NAME");
  app.add_option("--grid", given.grid, "frames a side, 2 to 64; default: the target's")
      ->type_name("N");
  app.add_option("--size", given.size, "texels a side of the whole picture; default: the target's")
      ->type_name("PX");
  app.add_option("--error", o.error_db,
                 "choose the smallest grid and size that come so close to the mesh: PSNR, dB")
      ->type_name("DB");
  app.add_option("--maps", given.maps, "color,normal,depth,orm; default: what the target reads")
      ->type_name("LIST");
  app.add_option("--format", given.format, "png (8 bits), png16 or exr (float)")
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--samples", o.samples,
                 "samples of a texel each way, 1 to 4; default: 2, or 3 for cut-out leaves")
      ->check(CLI::Range(1, 4))
      ->type_name("N");
}

void add_run_options(CLI::App& app, BakeOptions& o, Given& given) {
  app.option_defaults()->group("Run");
  app.add_option("--out", o.out, "folder for the files; made if it is missing")->type_name("DIR");
  app.add_option("--object", o.objects,
                 "name or number of an object, or a pattern with * and ?; may come several "
                 "times; default: each object")
      ->type_name("NAME");
  app.add_flag("--whole", o.whole, "bake all that stands in the scene as one object");
  app.add_option("--measure", given.measure,
                 "error to measure against the mesh: none, quick (4 radii, 4 directions, 256 "
                 "px) or full (4 distances, 24 directions, 512 px)")
      ->check(CLI::IsMember({"none", "quick", "full"}))
      ->capture_default_str();
  app.add_option("--shard", given.shard,
                 "bake the Ith of N shares of the objects; all shares write into one folder")
      ->type_name("I/N")
      ->capture_default_str();
  app.add_flag("--replace", o.replace, "write over another bake that is in the folder");
  app.add_flag("--dry-run", o.dry_run, "say what would be made, with sizes and times");
  app.add_flag("--json", o.json, "print the result as JSON");
  app.add_flag("--strict", o.strict, "refuse files with defects that viewers forgive");
  app.add_option("--clip", o.clip, "animation whose first pose is shown: name or number")
      ->type_name("NAME");
  app.add_option("--variant", o.variant, "material variant: name or number")->type_name("NAME");
  app.add_option("--device", o.device, "graphics device, as mirage-server --list-devices names it")
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--threads", o.threads, "threads; default: one per core")->type_name("N");
}

}  // namespace

int parse_options(int argc, char** argv, BakeOptions& options) {
  Given given;
  CLI::App app(
      "Bakes the objects of a scene into impostor atlases that engines read, and measures their "
      "error.",
      "mirage-bake");
  app.footer(
      "Example: mirage-bake tree.glb --whole --target godot4 --out tree\n"
      "         mirage-bake statue.glb --error 30 --out statue");
  app.add_option("SCENE", options.scene, "a .glb or .gltf file, or builtin:NAME")->required();
  add_picture_options(app, options, given);
  add_run_options(app, options, given);
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  if (const Result<void> right = check(given, options); !right) return fail(right.error());
  return -1;
}

}  // namespace mirage
