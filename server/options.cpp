#include "server/options.h"

#include <cstdio>

#include "protocol/base/cli.h"
#include "protocol/base/resources.h"
#include "server/net/metrics.h"
#include "server/net/web_pages.h"
#include "server/scene/builtin/builtin_scene.h"

namespace mirage {
namespace {

std::string footer() {
  std::string text = "Built-in scenes:\n";
  for (const BuiltinSceneInfo& scene : builtin_scenes()) {
    text += "  builtin:" + scene.name + "  " + scene.description + " (" + scene.options + ")\n";
  }
  text += "\nExample: mirage-server 'builtin:forest?trees=100' --listen 0.0.0.0:9870";
  return text;
}

/// Options as they are written; checked and put into ServerOptions once all are read.
struct Texts {
  std::string listen = "127.0.0.1:9870", codec = "auto", shadows = "off", log_format = "text";
  std::string store, admin, home;
  std::vector<std::string> trust_proxies;
  bool no_geometry = false, no_reference = false, references = false;
  bool no_view = false, no_web = false, downloads = false, no_downloads = false;
};

/// Checks an origin: scheme, host and port, without a path.
std::string is_origin(const std::string& text) {
  const std::size_t begin = text.find("://");
  const bool right = begin != std::string::npos && begin > 0 && begin + 3 < text.size() &&
                     text.find_first_of("/ ,;'\"", begin + 3) == std::string::npos;
  return right ? "" : "'" + text + "' is no origin, such as https://viewer.example:8443";
}

void add_scene_options(CLI::App& app, ServerOptions& o, Texts& t) {
  app.option_defaults()->group("Scene");
  app.add_option("SCENE", o.scene,
                 "a .glb or .gltf file[?variant=NAME&clip=NAME|N], or builtin:NAME[?key=value&…]");
  app.add_option("--environment", o.environment,
                 "light from all around: FILE.hdr or FILE.exr (equirectangular), builtin:studio, "
                 "builtin:sky or none; default: the studio for a file without lights")
      ->type_name("FILE");
  app.add_option("--shadows", t.shadows, "shadows of the sun")
      ->type_name("on|off")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app.add_flag("--strict", o.strict,
               "refuse what is otherwise repaired with a warning: missing images, odd URIs, …");
  app.add_option("--look", o.look,
                 "studio: show models without lights of their own before a backdrop, with their "
                 "shadow on a floor and highlights compressed; plain: on grey, as they are")
      ->type_name("LOOK")
      ->check(CLI::IsMember({"studio", "plain"}))
      ->capture_default_str();
  app.add_option("--home", t.home,
                 "the view that viewers begin with, in place of the scene's own: the eye, and a "
                 "point that it looks at, in metres")
      ->type_name("EX,EY,EZ,TX,TY,TZ");
  app.add_option("--write-environment", o.write_environment,
                 "write the surroundings to FILE.hdr or FILE.exr and exit")
      ->type_name("FILE");
}

void add_network_options(CLI::App& app, ServerOptions& o, Texts& t) {
  app.option_defaults()->group("Network");
  app.add_option("--listen", t.listen,
                 "serve on HOST:PORT, [IPv6]:PORT or unix:PATH; port 0 takes any free one")
      ->type_name("ADDRESS")
      ->take_last()
      ->capture_default_str();
  app.add_option("--port-file", o.port_file, "write the port to this file once ready")
      ->type_name("FILE");
  app.add_option("--max-clients", o.session.max_clients, "clients at a time")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  CLI::Option* web =
      app.add_option("--web", o.endpoint.web,
                     "serve the browser's page from this folder; default: the page that "
                     "scripts/web or an installation put beside this program")
          ->type_name("DIR");
  app.add_flag("--no-web", t.no_web, "serve no page to browsers")->excludes(web);
  app.add_option("--drain-s", o.endpoint.drain_s,
                 "after SIGTERM, answer what was asked for during at most so many seconds")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
}

void add_trust_options(CLI::App& app, ServerOptions& o, Texts& t) {
  app.option_defaults()->group("Who may see what");
  app.add_option("--token-file", o.token_file,
                 "admit only clients with a token of this file (docs/guide/operations.md has its "
                 "format); read again on SIGHUP")
      ->type_name("FILE");
  CLI::Option* cert = app.add_option("--tls-cert", o.endpoint.tls_cert,
                                     "serve wss:// and https:// with this PEM certificate chain; "
                                     "read again on SIGHUP")
                          ->type_name("FILE");
  CLI::Option* key =
      app.add_option("--tls-key", o.endpoint.tls_key, "private key of the certificate, PEM")
          ->type_name("FILE");
  cert->needs(key);
  key->needs(cert);
  app.add_option(
         "--allow-origin", o.endpoint.allow_origins,
         "accept pages of this origin, besides those of the server's own host; several times "
         "for several")
      ->allow_extra_args(false)
      ->check(is_origin, "ORIGIN")
      ->type_name("ORIGIN");
  app.add_option("--embed-origin", o.endpoint.embed_origins,
                 "let pages of this origin show the browser page in a frame; several times for "
                 "several")
      ->allow_extra_args(false)
      ->check(is_origin, "ORIGIN")
      ->type_name("ORIGIN");
  app.add_option("--trust-proxy", t.trust_proxies,
                 "believe proxies of this network what they forward (Forwarded, X-Forwarded-For, "
                 "-Host, -Proto), besides those of this machine; several times for several; none: "
                 "believe no proxy")
      ->allow_extra_args(false)
      ->type_name("ADDRESS[/LEN]");
  app.add_flag("--no-geometry", t.no_geometry,
               "never send meshes, so that nobody can copy the model; clients draw impostors only");
  app.add_flag("--references", t.references,
               "draw full renders for clients on other machines, too; they have depth, which "
               "tells the geometry")
      ->excludes(
          app.add_flag("--no-reference", t.no_reference,
                       "draw full renders for nobody, nor pictures for /v1/picture; default: "
                       "pictures for everybody, full renders for clients on this machine "
                       "only"));
  app.add_flag("--downloads", t.downloads,
               "make bakes and frozen folders for everybody who asks the page for them, at the "
               "lowest priority")
      ->excludes(app.add_flag("--no-downloads", t.no_downloads,
                              "make downloads for nobody; default: for visitors on this machine "
                              "only"));
  app.add_flag("--no-view", t.no_view,
               "do not send the first picture of the whole scene as one tile");
}

void add_storage_options(CLI::App& app, ServerOptions& o, Texts& t) {
  app.option_defaults()->group("Memory and storage");
  app.add_option("--scene-mb", o.scene_mb,
                 "memory that the scene may take, MB: files that need more are refused; default: "
                 "half of what the machine has")
      ->check(CLI::Range(1, 1 << 24));
  app.add_option("--choices", o.choices,
                 "clips and variants of a file that viewers may choose at a time; each is a scene "
                 "of its own, loaded when it is chosen; 0: all see what is served")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  app.add_option("--cache-mb", o.cache_mb, "memory for finished tiles, MB")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--cache-dir", o.cache_dir,
                 "keep finished tiles and levels of detail in this folder as well")
      ->type_name("DIR");
  app.add_option("--cache-dir-mb", o.cache_dir_mb, "largest size of that folder, MB")
      ->check(CLI::Range(1, 1 << 30))
      ->capture_default_str();
  app.add_flag("--cache-read-only", o.cache_read_only, "read that folder and change nothing in it");
  app.add_option("--store", t.store,
                 "share finished tiles with other servers through "
                 "redis://[:PASSWORD@]HOST[:PORT][/DATABASE]")
      ->type_name("URL");
}

void add_graphics_options(CLI::App& app, ServerOptions& o, Texts& t) {
  app.option_defaults()->group("Graphics and encoding");
  app.add_option("--device", o.render.device, "EGL device: auto, surfaceless, device0, …")
      ->type_name("NAME")
      ->capture_default_str();
  app.add_flag("--list-devices", o.list_devices, "print the EGL devices and exit");
  app.add_flag("--require-gpu", o.require_gpu,
               "end with exit code 4 and say what is missing if no graphics card draws");
  app.add_option("--gpu-mb", o.render.gpu_mb,
                 "graphics memory for the scene, tile pages and full renders, MB")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--page", o.render.page_edge,
                 "edge of the page into which many tiles are drawn, texels; larger suits a GPU")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  app.add_option("--supersample", o.render.supersample, "samples per texel along each axis")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  app.add_option("--codec", t.codec, "compression of tiles; auto: each client chooses by its link")
      ->type_name("NAME")
      ->check(CLI::IsMember({"auto", "raw", "zstd", "webp"}))
      ->capture_default_str();
  app.add_option("--encoders", o.encoders,
                 "threads that measure and compress tiles; default: with a graphics card 2 less "
                 "than there are cores, at most 14, else 1")
      ->check(CLI::Range(1, 64));
  app.add_option("--stand-in-ms", o.render.stand_in_ms,
                 "for load tests of many servers on one machine: send grey tiles, each after so "
                 "many ms asleep")
      ->check(CLI::Range(0.01, 10'000.0));
}

void add_operation_options(CLI::App& app, ServerOptions& o, Texts& t) {
  app.option_defaults()->group("Operation");
  app.add_flag("--check-config", o.check_config,
               "check options, configuration, token file and scene file, and exit");
  app.add_flag("--doctor", o.doctor,
               "check whether this machine can serve with these options: devices, limits, port, "
               "cache, certificate, store, one tile; exit");
  app.add_option("--admin", t.admin,
                 "serve /metrics, /healthz and /readyz on [HOST:]PORT; without HOST on this "
                 "machine only")
      ->type_name("ADDRESS");
  app.add_flag("--metrics", o.endpoint.metrics,
               "serve /metrics (Prometheus text) beside the scene, too");
  app.add_option("--log-format", t.log_format, "log on standard error: text, or one JSON a line")
      ->type_name("NAME")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
}

void add_analysis_options(CLI::App& app, ServerOptions& o) {
  app.option_defaults()->group("Analysis");
  CLI::Option* explain = app.add_flag(
      "--explain", o.explain, "print what each object needs and what is left out, and exit");
  app.add_flag("--json", o.json, "with --explain: print JSON")->needs(explain);
  CLI::Option* prove =
      app.add_flag("--prove", o.prove,
                   "with --explain: draw with and without what is left out, compare every byte");
  prove->needs(explain);
  app.add_option("--prove-cells", o.prove_cells, "with --prove: view cells of each object")
      ->needs(prove)
      ->check(CLI::Range(1, 26))
      ->capture_default_str();
  app.add_option("--prove-objects", o.prove_objects,
                 "with --prove: objects out of those with the same needs")
      ->needs(prove)
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
}

/// Addresses and files that texts name. Errors kUsage.
Result<void> read_addresses(ServerOptions& o, const Texts& t) {
  for (const std::string& network : t.trust_proxies) {
    if (Result<void> added = o.endpoint.proxies.add(network); !added) return added.error();
  }
  Result<ListenAddress> address = parse_listen(t.listen);
  if (!address) return address.error();
  o.endpoint.address = address.take();
  if (!t.admin.empty()) {
    const bool port_only = t.admin.find_first_not_of("0123456789") == std::string::npos;
    Result<ListenAddress> operators = parse_listen(port_only ? "127.0.0.1:" + t.admin : t.admin);
    if (!operators) return operators.error();
    o.endpoint.admin = operators.take();
  }
  if (!o.port_file.empty() && !o.endpoint.address.socket_path.empty()) {
    return make_error(ErrorId::kUsage, "--port-file: a unix socket has no port");
  }
  if (!t.store.empty()) {
    Result<StoreAddress> parsed = parse_store_url(t.store);
    if (!parsed) return parsed.error();
    o.store = parsed.take();
  }
  if (!t.home.empty()) {
    const Result<ViewPlace> home = parse_view_place(t.home);
    if (!home)
      return make_error(ErrorId::kUsage, "--home: " + home.error().text, home.error().hint);
    o.home = *home;
  }
  if (!o.token_file.empty()) {
    Result<Access> access = Access::read(o.token_file);
    if (!access) return access.error();
    o.session.access = access.take();
  }
  return {};
}

}  // namespace

int parse_options(int argc, char** argv, ServerOptions& o) {
  CLI::App app("Holds a scene and renders impostor tiles of it on request.", "mirage-server");
  app.footer(footer());
  Texts t;
  add_scene_options(app, o, t);
  add_network_options(app, o, t);
  add_trust_options(app, o, t);
  add_storage_options(app, o, t);
  add_graphics_options(app, o, t);
  add_operation_options(app, o, t);
  add_analysis_options(app, o);
  add_page(app, "--help-metrics", "print every metric of /metrics with its meaning and exit",
           metrics_page);
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  if (t.log_format == "json") o.log_format = LogFormat::kJson;
  if (o.list_devices || !o.write_environment.empty()) return -1;
  if (o.scene.empty() && o.doctor) o.scene = "builtin:knot";
  if (o.scene.empty()) {
    return fail(make_error(ErrorId::kUsage, "no SCENE given", "try mirage-server builtin:forest"));
  }
  if (const Result<void> read = read_addresses(o, t); !read) return fail(read.error());
  if (!t.no_web && o.endpoint.web.empty()) o.endpoint.web = web_folder_beside_program();
  if (o.scene_mb == 0) o.scene_mb = memory_bytes() / 2 >> 20;
  o.session.geometry = !t.no_geometry;
  // A full render has depth from anywhere, which is geometry. It also keeps the renderer busy.
  const bool unasked = !t.no_geometry && is_loopback(o.endpoint.address);
  o.session.reference = t.references || (unasked && !t.no_reference);
  o.session.pictures = !t.no_reference;
  o.session.view = !t.no_view;
  if (t.downloads || (unasked && !t.no_downloads)) {
    o.endpoint.downloads =
        DownloadScene{o.scene, o.environment, o.look, o.render.device, o.session.geometry};
  }
  o.shadows = t.shadows == "on";
  if (const std::optional<TileCodec> only = codec_from_name(t.codec)) {
    o.session.codecs = {*only};
    if (is_lossy(*only)) o.session.codecs.push_back(TileCodec::kZstd);
  }
  return -1;
}

}  // namespace mirage
