#include "client/freeze/options.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstdio>

#include "protocol/base/cli.h"
#include "protocol/base/limits.h"
#include "protocol/base/result.h"
#include "protocol/codec/codec_id.h"

namespace mirage {
namespace {

constexpr double kFarthestM = 1e9;

Result<EyeBox> parse_box(const std::string& text) {
  double v[6];
  char extra = 0;
  const int read = std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf%c", &v[0], &v[1], &v[2],
                               &v[3], &v[4], &v[5], &extra);
  bool good = read == 6;
  for (int i = 0; good && i < 6; ++i) good = std::abs(v[i]) <= kFarthestM;  // false for NaN
  for (int i = 0; good && i < 3; ++i) good = v[i] <= v[i + 3];
  if (good) return EyeBox{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  return make_error(ErrorId::kUsage, "--box: '" + text + "' is no box",
                    "X0,Y0,Z0,X1,Y1,Z1 in metres, no first number above its second: "
                    "--box -1,1.5,-1,1,1.8,1");
}

/// Options as they are written.
struct Texts {
  std::string size = "1280x720", box, home, shard = "1/1";
};

Result<void> check(FreezeOptions& o, const Texts& t) {
  char extra = 0;
  if (std::sscanf(t.size.c_str(), "%5ux%5u%c", &o.width, &o.height, &extra) != 2 || o.width < 16 ||
      o.height < 16 || o.width > 8192 || o.height > 8192) {
    return make_error(ErrorId::kUsage, "'" + t.size + "' is no size", "for example 1280x720");
  }
  if (!t.box.empty()) {
    const Result<EyeBox> parsed = parse_box(t.box);
    if (!parsed) return parsed.error();
    o.box = *parsed;
  }
  if (!t.home.empty()) {
    const Result<ViewPlace> home = parse_view_place(t.home);
    if (!home)
      return make_error(ErrorId::kUsage, "--home: " + home.error().text, home.error().hint);
    o.home = *home;
  }
  const Result<Shard> parsed = parse_shard(t.shard);
  if (!parsed) return parsed.error();
  o.shard = *parsed;
  if (o.out.empty()) return make_error(ErrorId::kUsage, "--out names no folder");
  return {};
}

void add_scene_options(CLI::App& app, FreezeOptions& o) {
  app.option_defaults()->group("Scene");
  app.add_option("SCENE", o.scene, "a .glb or .gltf file, or a built-in scene such as builtin:knot")
      ->required();
  app.add_option("--environment", o.environment, "as of mirage-server")->type_name("FILE");
  app.add_option("--look", o.look, "as of mirage-server")
      ->check(CLI::IsMember({"studio", "plain"}));
  app.add_option("--device", o.device, "graphics device of the server")->capture_default_str();
}

void add_folder_options(CLI::App& app, FreezeOptions& o, Texts& t) {
  app.option_defaults()->group("Folder");
  app.add_option("--out", o.out, "folder to write; it is made if it does not exist")
      ->type_name("DIR")
      ->required();
  app.add_option("--mb", o.mb, "most MB of the folder; what shows least is left out")
      ->check(number_within(0.1, 1e6))
      ->capture_default_str();
  app.add_flag("!--no-geometry", o.geometry, "keep meshes at home: pictures alone are written");
  app.add_option("--codec", o.codec, "codec of the tiles")
      ->check(CLI::IsMember({"webp", "zstd"}))
      ->capture_default_str();
  app.add_option("--shard", t.shard,
                 "make the Ith of N shares; all write into one folder, and the last one that ends "
                 "writes the index")
      ->capture_default_str()
      ->type_name("I/N");
  app.add_flag("--dry-run", o.dry_run,
               "look from an eighth of the eyes, write nothing, and print "
               "about how many files, MB and seconds it takes");
}

void add_eye_options(CLI::App& app, FreezeOptions& o, Texts& t) {
  app.option_defaults()->group("Eyes");
  app.add_option("--error", o.error_px, "error that a view may show, px of --size")
      ->check(number_within(0.05, 100))
      ->capture_default_str();
  app.add_option("--box", t.box,
                 "X0,Y0,Z0,X1,Y1,Z1: box of the eyes, m, looking everywhere; without it they stand "
                 "around the scene and look at it")
      ->type_name("BOX");
  app.add_option("--home", t.home,
                 "the view that the page begins with, in place of the scene's own: the eye, and a "
                 "point that it looks at, m")
      ->type_name("EX,EY,EZ,TX,TY,TZ");
  app.add_option("--eyes", o.eyes,
                 "eyes of a turn around the scene; in a box, three times the "
                 "eyes along its longest side")
      ->check(CLI::Range(4, 360))
      ->capture_default_str();
  app.add_option("--size", t.size, "size of the picture that they see, WxH pixels")
      ->type_name("WxH")
      ->capture_default_str();
  app.add_option("--fov", o.fov_degrees, "its vertical field of view, degrees")
      ->check(number_within(1, 120))
      ->capture_default_str();
}

}  // namespace

std::string FreezeOptions::settings() const {
  std::string eyes_in = "around";
  if (box) {
    eyes_in = fmt::format("{},{},{},{},{},{}", box->low.x, box->low.y, box->low.z, box->high.x,
                          box->high.y, box->high.z);
  }
  return fmt::format("mb={} error={} eyes={} in={} size={}x{} fov={} geometry={} codec={}{}", mb,
                     error_px, eyes, eyes_in, width, height, fov_degrees, geometry, codec,
                     home ? " home=" + to_text(*home) : "");
}

int parse_options(int argc, char** argv, FreezeOptions& o) {
  CLI::App app("Writes a scene as a folder that any web host serves, without a server.",
               "mirage-freeze");
  app.footer(
      "The folder has a page, index.html, and all that a viewer asks a server for when it looks "
      "from the eyes. A run that was interrupted goes on where it was.\n\n"
      "Example: mirage-freeze statue.glb --out statue --mb 20 && python3 -m http.server -d statue");
  Texts t;
  add_scene_options(app, o);
  add_folder_options(app, o, t);
  add_eye_options(app, o, t);
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  if (const Result<void> checked = check(o, t); !checked) return fail(checked.error());
  return -1;
}

}  // namespace mirage
