#include "client/load/options.h"

#include <cmath>
#include <fstream>

#include "client/frame/camera_path.h"
#include "client/load/report.h"
#include "protocol/base/cli.h"
#include "protocol/base/limits.h"

namespace mirage {
namespace {

constexpr double kMaxPlannedAsks = 20e6;  // some 16 bytes each

// CLI::Range lets NaN through: no comparison with it is true.
Result<void> check_finite(const LoadOptions& o) {
  const std::pair<const char*, double> values[] = {{"--duration", o.duration_s},
                                                   {"--rate", o.rate_hz},
                                                   {"--spread", o.spread_s},
                                                   {"--fps", o.fps},
                                                   {"--fov", o.fov_degrees},
                                                   {"--tau", o.tau_px},
                                                   {"--verify", o.verify_share},
                                                   {"--connect-rate", o.connects_per_s},
                                                   {"--connect-timeout", o.connect_timeout_s}};
  for (const auto& [name, value] : values) {
    if (!std::isfinite(value)) {
      return make_error(ErrorId::kUsage, std::string(name) + " must be a finite number");
    }
  }
  return {};
}

Result<void> check(LoadOptions& o, const std::string& size, const std::string& token_file) {
  if (Result<void> finite = check_finite(o); !finite) return finite;
  Result<ServerUrl> url = parse_url(o.url_text);
  if (!url) return url.error();
  url->ca_file = std::move(o.url.ca_file);
  o.url = url.take();
  char extra = 0;
  if (std::sscanf(size.c_str(), "%5ux%5u%c", &o.width, &o.height, &extra) != 2 || o.width < 1 ||
      o.height < 1 || o.width > 8192 || o.height > 8192) {
    return make_error(ErrorId::kUsage, "'" + size + "' is no size", "for example 640x360");
  }
  if (o.clients * o.rate_hz * o.duration_s > kMaxPlannedAsks) {
    return make_error(ErrorId::kUsage, "more than 20 million requests in all",
                      "lower --clients, --rate or --duration");
  }
  // The path's own errors come before any connection; its scene is not known yet.
  if (Result<CameraPath> path = CameraPath::create(o.path, HomeView{}, glm::dvec3(0), 1); !path) {
    return path.error();
  }
  if (!token_file.empty()) {
    std::ifstream file(token_file);
    if (!std::getline(file, o.token)) {
      return make_error(ErrorId::kUsage, "token file '" + token_file + "' has no first line");
    }
  }
  return {};
}

void add_load_options(CLI::App& app, LoadOptions& o) {
  app.option_defaults()->group("Load");
  app.add_option("URL", o.url_text, "address of the server, such as ws://127.0.0.1:9870")
      ->required();
  app.add_option("--clients", o.clients, "connections at a time")
      ->check(CLI::Range(1, 60'000))
      ->capture_default_str();
  app.add_option("--duration", o.duration_s, "seconds during which clients ask")
      ->check(CLI::Range(0.1, 86'400.0))
      ->capture_default_str();
  app.add_option("--rate", o.rate_hz, "tiles that each client asks for per second")
      ->check(CLI::Range(0.001, 10'000.0))
      ->capture_default_str();
  app.add_flag("--reconnect", o.reconnect,
               "clients that lose the server connect again and repeat what they waited for");
  app.add_option("--connect-rate", o.connects_per_s, "connections opened per second")
      ->check(CLI::Range(1.0, 100'000.0))
      ->capture_default_str();
  app.add_option("--connect-timeout", o.connect_timeout_s,
                 "give up connecting or warming after so many seconds without progress")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  app.add_option("--seed", o.seed, "seed of the clients' starting points and times")
      ->capture_default_str();
}

void add_view_options(CLI::App& app, LoadOptions& o, std::string& size) {
  app.option_defaults()->group("What clients look at");
  app.add_option("--path", o.path,
                 "camera path: a file of `x y z rx ry rz t_ms` lines, or "
                 "builtin:still|orbit|walk|fly|shake|strafe|teleport")
      ->type_name("PATH")
      ->capture_default_str();
  app.add_option("--spread", o.spread_s,
                 "clients start within so many seconds of the path; 0: all at one point")
      ->check(CLI::Range(0.0, 86'400.0))
      ->capture_default_str();
  app.add_option("--fps", o.fps, "camera steps per second")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--size", size, "size of the clients' pictures, WxH pixels")
      ->type_name("WxH")
      ->capture_default_str();
  app.add_option("--fov", o.fov_degrees, "vertical field of view, degrees")
      ->check(CLI::Range(limits::kMinFovDegrees, limits::kMaxFovDegrees))
      ->capture_default_str();
  app.add_option("--tau", o.tau_px, "error that an impostor may show, pixels")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
}

void add_result_options(CLI::App& app, LoadOptions& o, std::string& token_file,
                        std::string& shard) {
  app.option_defaults()->group("Warming, results");
  CLI::Option* warm =
      app.add_flag("--warm", o.warm, "first ask for every tile of the run once, without measuring");
  app.add_option(
         "--warm-shard", shard,
         "ask once for the Ith of N shares of the run's tiles, then end; N machines fill a shared "
         "store in this way")
      ->type_name("I/N")
      ->excludes(warm);
  app.add_option("--verify", o.verify_share, "share of the tiles that are decoded and checked")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--json", o.json_file, "write the results to this file as JSON")
      ->type_name("FILE");
  app.add_option("--urls", o.urls_file, "write the HTTP paths of the run's tiles to this file")
      ->type_name("FILE");
  app.add_option("--token-file", token_file, "file whose first line is the server's token")
      ->type_name("FILE");
  app.add_option("--tls-ca", o.url.ca_file,
                 "PEM file of certificates to trust beside those of the system")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
}

}  // namespace

int parse_options(int argc, char** argv, LoadOptions& o) {
  CLI::App app("Loads a mirage-server with scripted clients and reports latency.", "mirage-load");
  app.footer(
      "Requests leave at times that are fixed beforehand. Latency counts from those times, so that "
      "a stalled client still counts. The exit code is 6 if a tile fails verification.\n\n"
      "Example: mirage-load ws://127.0.0.1:9870 --clients 100 --duration 10 --rate 5 --warm "
      "--json load.json");
  std::string size = "640x360", token_file, shard;
  add_load_options(app, o);
  add_view_options(app, o, size);
  add_result_options(app, o, token_file, shard);
  add_page(app, "--help-statistics", "print every figure of --json with its meaning and exit",
           load_statistics_page);
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  if (!shard.empty()) {
    const Result<Shard> parsed = parse_shard(shard);
    if (!parsed) return fail(parsed.error());
    o.warm_shard = *parsed;
  }
  if (const Result<void> checked = check(o, size, token_file); !checked) {
    return fail(checked.error());
  }
  return -1;
}

}  // namespace mirage
