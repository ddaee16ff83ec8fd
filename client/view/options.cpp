#include "client/view/options.h"

#include <fstream>
#include <map>

#include "client/host/device_model.h"
#include "client/host/folder_link.h"
#include "client/host/methods.h"
#include "client/native/server_url.h"
#include "client/view/statistics_page.h"
#include "protocol/base/cli.h"
#include "protocol/base/limits.h"

namespace mirage {
namespace {

const std::map<std::string, RelightChoice> kRelight = {{"auto", RelightChoice::kAuto},
                                                       {"always", RelightChoice::kAlways},
                                                       {"never", RelightChoice::kNever}};

CLI::Validator no_longer_than(std::size_t bytes) {
  return CLI::Validator(
      [bytes](const std::string& text) {
        return text.size() <= bytes ? std::string()
                                    : "longer than " + std::to_string(bytes) + " bytes";
      },
      "");
}

Result<void> parse_size(const std::string& text, ViewOptions& o) {
  int w = 0, h = 0;
  char extra = 0;
  const bool read = std::sscanf(text.c_str(), "%dx%d%c", &w, &h, &extra) == 2;
  constexpr int kLongest = 16384, kMostPixels = 8192 * 8192;
  if (!read || w < 1 || h < 1 || w > kLongest || h > kLongest || w > kMostPixels / h) {
    return make_error(ErrorId::kUsage, "'" + text + "' is no size",
                      "for example 640x360; at most 16384 a side and 67 million pixels");
  }
  o.width = w;
  o.height = h;
  return {};
}

Result<void> check(ViewOptions& o, const std::string& offscreen, const std::string& size,
                   const std::string& net) {
  if (!offscreen.empty()) {
    o.offscreen = true;
    if (Result<void> r = parse_size(offscreen, o); !r) return r;
  } else if (!size.empty()) {
    if (Result<void> r = parse_size(size, o); !r) return r;
  }
  if (!net.empty()) {
    Result<NetModel> model = parse_net_model(net);
    if (!model) return model.error();
    o.net = *model;
  }
  if (o.virtual_time && !o.offscreen) {
    return make_error(ErrorId::kUsage, "--virtual-time needs --offscreen WxH");
  }
  if (o.reference_every > 0 &&
      !limits::reference_within_limits(static_cast<std::uint32_t>(o.width),
                                       static_cast<std::uint32_t>(o.height),
                                       static_cast<std::uint32_t>(o.reference_supersample))) {
    return make_error(ErrorId::kUsage,
                      "a full render is at most 8192 pixels an edge and 33 million samples",
                      "a smaller frame, fewer --reference-samples, or no --reference");
  }
  if (!o.device_model_name.empty()) {
    if (!o.virtual_time) {
      return make_error(ErrorId::kUsage, "--device-model needs --virtual-time",
                        "in real time it is measured what frames take");
    }
    Result<CostModel> model = read_device_model(o.device_model_name);
    if (!model) return model.error();
    o.device_model = *model;
  }
  const Result<ServerUrl> url = parse_url(o.url);
  if (!url && !is_frozen_folder(o.url)) return url.error();
  if (url.ok() && o.scene.choice.clip.empty()) o.scene.choice.clip = url->choice.clip;
  if (url.ok() && o.scene.choice.variant.empty()) o.scene.choice.variant = url->choice.variant;
  o.method = *method_from_name(o.method_name);
  o.relight = kRelight.at(o.relight_name);
  if (o.msaa_name != "auto") o.msaa = std::stoi(o.msaa_name);
  if (o.offscreen && o.length.frames == 0 && o.length.seconds == 0) o.length.frames = 300;
  if (o.offscreen && o.path.empty()) o.path = "builtin:walk";
  if (!o.token_file.empty()) {
    std::ifstream file(o.token_file);
    if (!std::getline(file, o.token)) {
      return make_error(ErrorId::kUsage, "token file '" + o.token_file + "' has no first line");
    }
  }
  return {};
}

/// Sizes and the network as they are written.
struct Texts {
  std::string offscreen, size, net;
};

void add_picture_options(CLI::App& app, ViewOptions& o, Texts& t) {
  app.option_defaults()->group("Picture");
  app.add_option("URL", o.url,
                 "address of the server, such as ws://127.0.0.1:9870, or a frozen folder")
      ->required();
  app.add_option("--offscreen", t.offscreen, "draw WxH pixels without a display")->type_name("WxH");
  app.add_option("--size", t.size, "size of the window, WxH pixels")->type_name("WxH");
  app.add_option("--fov", o.fov_degrees, "vertical field of view, degrees")
      ->check(number_within(limits::kMinFovDegrees, limits::kMaxFovDegrees))
      ->capture_default_str();
  app.add_option("--tau", o.tau_px, "error that an impostor may show, pixels")
      ->check(number_within(0.01, 1000.0))
      ->capture_default_str();
  app.add_option("--frame-ms", o.frame_ms,
                 "time budget of a frame, ms; 0: none; default: the display's interval, 50 on a "
                 "software renderer, none on virtual time")
      ->check(number_within(0.0, 10'000.0));
  app.add_option("--msaa", o.msaa_name,
                 "samples per pixel, 0 to 16; auto: 4, or 1 where that pays within --frame-ms")
      ->type_name("N|auto")
      ->check(CLI::Range(0, 16) | CLI::IsMember({"auto"}))
      ->capture_default_str();
  app.add_option("--shadows", o.scene.shadows,
                 "off: draw without shadows even if the server has them")
      ->type_name("on|off")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app.add_option("--clip", o.scene.choice.clip,
                 "play this clip of the scene alone, by its name as the log lists it; as "
                 "?clip=NAME in the URL")
      ->type_name("NAME")
      ->check(no_longer_than(limits::kMaxChoiceBytes));
  app.add_option("--variant", o.scene.choice.variant,
                 "show this variant of the materials; as ?variant=NAME in the URL")
      ->type_name("NAME")
      ->check(no_longer_than(limits::kMaxChoiceBytes));
  app.add_option("--animation", o.scene.animation,
                 "off: moving objects stay at the start of their clip")
      ->type_name("on|off")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
}

void add_motion_options(CLI::App& app, ViewOptions& o) {
  app.option_defaults()->group("Camera and light");
  app.add_option("--path", o.path,
                 "camera path: a file of `x y z rx ry rz t_ms` lines, "
                 "builtin:still|orbit|walk|fly|shake|strafe|teleport, or a browser's "
                 "'#eye=X,Y,Z&look=X,Y,Z'")
      ->type_name("PATH");
  app.add_option("--frames", o.length.frames,
                 "end after so many frames; default: 300 offscreen, else when the window closes")
      ->check(CLI::Range(1, 10'000'000));
  app.add_option("--seconds", o.length.seconds, "end after so many seconds of the path")
      ->check(number_within(0.01, 1e6));
  app.add_option("--fps", o.fps, "frames per second of the path")
      ->check(number_within(1.0, 1000.0))
      ->capture_default_str();
  app.add_option("--light", o.light,
                 "file of `t_ms ambient_rgb sun_rgb sun_dir_xyz` lines, or "
                 "builtin:fixed|sun-sweep|lamp-toggle")
      ->type_name("FILE")
      ->capture_default_str();
}

void add_connection_options(CLI::App& app, ViewOptions& o) {
  app.option_defaults()->group("Connection and memory");
  app.add_option("--token-file", o.token_file, "file whose first line is the server's token")
      ->type_name("FILE");
  app.add_option("--tls-ca", o.ca_file,
                 "PEM file of certificates to trust beside those of the system")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  app.add_option("--connect-timeout", o.connect_timeout_s, "seconds to wait for the server")
      ->check(number_within(0.1, 3600.0))
      ->capture_default_str();
  app.add_option("--rate-mbps", o.targets.rate_mbps,
                 "hold the download to so many Mbit/s by raising tau; 0: no limit")
      ->check(number_within(0.0, 100'000.0))
      ->capture_default_str();
  app.add_option("--codec", o.codec_name,
                 "compression of tiles; auto: lossy colours on a thin, full link, else zstd")
      ->type_name("NAME")
      ->check(CLI::IsMember({"auto", "raw", "zstd", "webp"}))
      ->capture_default_str();
  app.add_option("--atlas-mb", o.atlas_mb, "limit of graphics memory for tiles, MB")
      ->check(CLI::Range(9, 8192))
      ->capture_default_str();
  app.add_option("--mesh-mb", o.mesh_mb, "limit of graphics memory for geometry and its images, MB")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  app.add_option(
         "--upload-kb", o.upload_kb,
         "limit of bytes to the graphics card per frame, KB; one tile, mesh or image may be larger")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
}

void add_output_options(CLI::App& app, ViewOptions& o) {
  app.option_defaults()->group("Output and comparison");
  app.add_option("--out", o.out_dir, "write every frame into this folder as PNG")->type_name("DIR");
  app.add_option("--stats", o.stats_file, "write statistics to this file as JSON")
      ->type_name("FILE");
  app.add_option("--reference", o.reference_every,
                 "compare every Nth frame with the server's full render; 0: none")
      ->check(CLI::Range(0, 1'000'000));
  app.add_option("--reference-samples", o.reference_supersample,
                 "samples per pixel along each axis of the full render")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  app.add_option("--explain-frame", o.explain_file,
                 "write why the last frame is drawn as it is, as JSON: for each object the choice "
                 "and its alternatives, with error and ms")
      ->type_name("FILE");
  app.add_option(
         "--trace", o.trace_file,
         "write the life of every tile, from request to first draw, and the stages of every "
         "frame, as JSON")
      ->type_name("FILE");
}

void add_reproducible_options(CLI::App& app, ViewOptions& o, Texts& t) {
  app.option_defaults()->group("Reproducible runs");
  app.add_flag("--virtual-time", o.virtual_time,
               "advance time by whole frames and the network by its model: every run is the same "
               "to the byte; needs --offscreen");
  app.add_option("--net", t.net,
                 "modelled network, for example rtt=100,jitter=20,rate=20,loss=0.5,server-ms=5,"
                 "seed=1 (ms, ms, Mbit/s, %, ms)")
      ->type_name("MODEL");
  app.add_option("--device-model", o.device_model_name,
                 "time that frames take on virtual time: software, laptop, phone or a JSON file "
                 "of prices; default: none")
      ->type_name("NAME");
}

void add_experiment_options(CLI::App& app, ViewOptions& o) {
  app.option_defaults()->group("Experiments");
  app.add_option("--method", o.method_name,
                 "draw all impostors in one way; auto: the cheapest within tau; fixed8: the "
                 "classic eight flat views")
      ->type_name("NAME")
      ->check(CLI::IsMember(method_names()))
      ->capture_default_str();
  app.add_option("--relight", o.relight_name,
                 "shade impostors in the viewer; auto: while the light keeps changing")
      ->type_name("WHEN")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->capture_default_str();
  app.add_flag("--no-view{false}", o.views,
               "do not use the picture of the whole scene where objects have no image yet");
  app.add_option(
         "--march-kpx", o.march_kpx,
         "limit of pixels per frame drawn by marching through depth, thousands; default: none")
      ->check(number_within(0.0, 1e5));
  app.add_option(
         "--mesh-radii", o.mesh_radii,
         "largest distance, in radii of the object, at which geometry is drawn; default: any, or 8 "
         "with a fixed --method")
      ->check(number_within(0.0, 1000.0));
  app.add_flag("--gles", o.graphics.gles, "offscreen: draw with OpenGL ES 3, as a browser does");
  app.add_option("--device", o.graphics.device, "offscreen: EGL device")
      ->type_name("NAME")
      ->capture_default_str();
}

}  // namespace

int parse_options(int argc, char** argv, ViewOptions& o) {
  CLI::App app("Shows the scene of a mirage-server, drawn with impostors.", "mirage-view");
  app.footer(
      "In the window: W A S D or arrows move, Q and E go down and up, dragging looks, Shift is "
      "fast, M changes between orbit and walk, G flies or walks on the ground, space stops what "
      "moves, N shows the next clip and B "
      "the "
      "next variant, O shows figures, 1 to 5 show how the picture is made, Esc ends.\n\n"
      "Example: mirage-view ws://127.0.0.1:9870 --offscreen 640x360 --path builtin:walk "
      "--frames 300 --virtual-time --net rtt=100,rate=20 --reference 10 --stats stats.json");
  Texts t;
  add_picture_options(app, o, t);
  add_motion_options(app, o);
  add_connection_options(app, o);
  add_output_options(app, o);
  add_reproducible_options(app, o, t);
  add_experiment_options(app, o);
  add_page(app, "--help-statistics", "print every figure of --stats with its meaning and exit",
           statistics_page);
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  if (const Result<void> checked = check(o, t.offscreen, t.size, t.net); !checked) {
    return fail(checked.error());
  }
  return -1;
}

}  // namespace mirage
