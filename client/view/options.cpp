#include "client/view/options.h"

#include <fstream>
#include <map>

#include "client/host/device_model.h"
#include "client/host/methods.h"
#include "protocol/base/cli.h"
#include "protocol/base/limits.h"

namespace mirage {
namespace {

const std::map<std::string, RelightChoice> kRelight = {{"auto", RelightChoice::kAuto},
                                                       {"always", RelightChoice::kAlways},
                                                       {"never", RelightChoice::kNever}};

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
  o.method = *method_from_name(o.method_name);
  o.relight = kRelight.at(o.relight_name);
  if (o.msaa_name != "auto") o.msaa = std::stoi(o.msaa_name);
  if (o.offscreen && o.frames == 0) o.frames = 300;
  if (o.offscreen && o.path.empty()) o.path = "builtin:walk";
  if (!o.token_file.empty()) {
    std::ifstream file(o.token_file);
    if (!std::getline(file, o.token)) {
      return make_error(ErrorId::kUsage, "token file '" + o.token_file + "' has no first line");
    }
  }
  return {};
}

}  // namespace

int parse_options(int argc, char** argv, ViewOptions& o) {
  CLI::App app("Shows a scene from a mirage-server by impostors.", "mirage-view");
  app.footer(
      "Window: W A S D or arrows move, Q E down and up, drag looks, Shift is fast, O the overlay, "
      "1 to 5 what "
      "is drawn from what (tile borders, bound, age, geometry), "
      "Esc ends.\nExample: mirage-view ws://127.0.0.1:9870 --offscreen 640x360 --path builtin:walk "
      "--frames 300 --virtual-time --net rtt=100,rate=20 --reference 10 --stats stats.json");
  std::string offscreen, size, net;
  app.add_option("URL", o.url, "server address, ws://HOST:PORT")->required();
  app.add_option("--offscreen", offscreen, "WxH: render without a display");
  app.add_option("--size", size, "WxH of the window");
  app.add_option("--path", o.path,
                 "file of `x y z rx ry rz t_ms` lines, builtin:still|orbit|walk|fly|shake|strafe|"
                 "teleport, or a view as in a browser's address: '#eye=X,Y,Z&look=X,Y,Z'");
  app.add_option("--light", o.light,
                 "file of `t_ms ambient_rgb sun_rgb sun_dir_xyz` lines, or builtin:fixed|sun-sweep|"
                 "lamp-toggle")
      ->capture_default_str();
  app.add_option(
         "--relight", o.relight_name,
         "shade impostors here, from albedo and normals; auto: while the light keeps changing")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->capture_default_str();
  app.add_option("--frames", o.frames, "stop after this many")->check(CLI::Range(1, 10'000'000));
  app.add_option("--fps", o.fps, "frame rate of the path")
      ->check(number_within(1.0, 1000.0))
      ->capture_default_str();
  app.add_option("--fov", o.fov_degrees, "vertical field of view in degrees")
      ->check(number_within(limits::kMinFovDegrees, limits::kMaxFovDegrees))
      ->capture_default_str();
  app.add_flag("--virtual-time", o.virtual_time,
               "time advances by whole frames, the network by its model: reproducible");
  app.add_option(
      "--device-model", o.device_model_name,
      "what frames take on virtual time: software, laptop, phone or a JSON file of prices; "
      "default: nothing");
  app.add_option("--net", net,
                 "network model: rtt=100,jitter=20,rate=20,loss=0.5,server-ms=5,seed=1");
  app.add_option("--tau", o.tau_px, "error target in pixels")
      ->check(number_within(0.01, 1000.0))
      ->capture_default_str();
  app.add_option(
         "--frame-ms", o.frame_ms,
         "budget of a frame in ms, spent where it takes away most error; 0: none; default: the "
         "display's pace, 50 on a software renderer, none on virtual time")
      ->check(number_within(0.0, 10'000.0));
  app.add_option("--rate-mbps", o.targets.rate_mbps,
                 "rate down to hold by raising tau, Mbit/s; 0: none")
      ->check(number_within(0.0, 100'000.0))
      ->capture_default_str();
  app.add_option("--method", o.method_name,
                 "how impostors are drawn; fixed8 is a baseline: eight "
                 "baked views around the horizon, the nearest on a flat quad")
      ->check(CLI::IsMember(method_names()))
      ->capture_default_str();
  app.add_option("--reference", o.reference_every, "compare every Nth frame with a full render")
      ->check(CLI::Range(0, 1'000'000));
  app.add_option("--reference-samples", o.reference_supersample, "samples per pixel and axis in it")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  app.add_option("--msaa", o.msaa_name,
                 "samples per pixel, 0 to 16 (0 and 1: one); auto: 4, or 1 where that pays within "
                 "--frame-ms")
      ->check(CLI::Range(0, 16) | CLI::IsMember({"auto"}))
      ->capture_default_str();
  app.add_flag("--no-view{false}", o.views,
               "no picture of the whole scene where objects have none of their own yet");
  app.add_option("--march-kpx", o.march_kpx,
                 "limit, for experiments: thousand pixels a frame that may be drawn by marching "
                 "depth; default: none")
      ->check(number_within(0.0, 1e5));
  app.add_option("--atlas-mb", o.atlas_mb,
                 "graphics memory for tiles at most; it is taken as they need it")
      ->check(CLI::Range(9, 8192))
      ->capture_default_str();
  app.add_option("--animation", o.animation, "off: everything stands at the start of its clip")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app.add_option("--shadows", o.shadows, "off: without shadows, also when the server has them")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app.add_option(
         "--mesh-radii", o.mesh_radii,
         "limit, for experiments: nothing farther than this many radii is geometry, but what "
         "is smaller than a tile; default: none, or 8 with a fixed --method")
      ->check(number_within(0.0, 1000.0));
  app.add_option("--mesh-mb", o.mesh_mb, "graphics memory for geometry and its images")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  app.add_option("--upload-kb", o.upload_kb,
                 "to the graphics card in a frame at most, but for a single tile, mesh or image")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--out", o.out_dir, "write every frame here as PNG");
  app.add_option("--stats", o.stats_file, "write statistics here as JSON");
  app.add_option(
      "--explain-frame", o.explain_file,
      "write here, as JSON, why the last frame is drawn as it is: of each thing what was "
      "chosen and what else there was, with error and ms");
  app.add_option("--trace", o.trace_file, "write the life of every tile here as JSON");
  app.add_option("--codec", o.codec_name,
                 "tiles' codec; auto: lossy colours on a thin link that is full, else zstd")
      ->check(CLI::IsMember({"auto", "raw", "zstd", "webp"}))
      ->capture_default_str();
  app.add_option("--token-file", o.token_file, "the server's token");
  app.add_flag("--gles", o.graphics.gles, "offscreen: draw with OpenGL ES 3, as in a browser");
  app.add_option("--device", o.graphics.device, "EGL device when offscreen")->capture_default_str();
  app.add_option("--connect-timeout", o.connect_timeout_s, "seconds to wait for the server")
      ->check(number_within(0.1, 3600.0))
      ->capture_default_str();
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  if (const Result<void> checked = check(o, offscreen, size, net); !checked) {
    return fail(checked.error());
  }
  return -1;
}

}  // namespace mirage
