#include "server/options.h"

#include <cstdio>

#include "protocol/base/cli.h"
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

}  // namespace

int parse_options(int argc, char** argv, ServerOptions& o) {
  CLI::App app("Holds a scene and renders impostor tiles of it on request.", "mirage-server");
  app.footer(footer());
  std::string listen = "127.0.0.1:9870", codec = "auto", store, admin;
  bool no_geometry = false, no_reference = false, references = false, no_view = false,
       no_web = false;
  std::string shadows = "off";
  app.add_option("SCENE", o.scene,
                 "a .glb or .gltf file[?variant=NAME], or builtin:NAME[?key=value&…]");
  app.add_flag(
      "--strict", o.strict,
      "refuse what viewers forgive: missing images, odd URIs, children listed as roots, …");
  app.add_option("--environment", o.environment,
                 "light from all around: FILE.hdr or FILE.exr (equirectangular), builtin:studio, "
                 "builtin:sky, none; default: the studio for a file without lights, else none");
  app.add_option("--write-environment", o.write_environment,
                 "write the surroundings (default the studio) as FILE.hdr or FILE.exr and exit");
  app.add_option("--listen", listen,
                 "HOST:PORT, [IPv6]:PORT or unix:PATH to serve on; port 0 takes any free one")
      ->take_last()
      ->capture_default_str();
  app.add_option("--port-file", o.port_file, "write the port here once ready");
  app.add_option("--cache-mb", o.cache_mb, "memory for finished tiles")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--cache-dir", o.cache_dir,
                 "keep finished tiles and levels of detail in this directory, too");
  app.add_flag("--cache-read-only", o.cache_read_only,
               "take what lies in the cache's directory, and change nothing there");
  app.add_option("--cache-dir-mb", o.cache_dir_mb, "what may lie in it")
      ->check(CLI::Range(1, 1 << 30))
      ->capture_default_str();
  app.add_option("--store", store,
                 "redis://[:PASSWORD@]HOST[:PORT][/DATABASE]: keep finished tiles there, too, and "
                 "share them with the servers that do");
  app.add_option(
         "--codec", codec,
         "tile codec; auto: each client chooses by its link, else this one for all (beside a "
         "lossy one zstd, where it is smaller)")
      ->check(CLI::IsMember({"auto", "raw", "zstd", "webp"}))
      ->capture_default_str();
  app.add_option("--encoders", o.encoders, "encoder threads")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--device", o.render.device, "EGL device: auto, surfaceless, device0, …")
      ->capture_default_str();
  app.add_flag("--list-devices", o.list_devices, "show the EGL devices and exit");
  app.add_option("--gpu-mb", o.render.gpu_mb,
                 "graphics memory for the scene, tile pages and full renders")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--page", o.render.page_edge, "tile page edge in texels; larger suits a GPU")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  app.add_option("--supersample", o.render.supersample, "samples per texel and axis")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  app.add_option("--stand-in-ms", o.render.stand_in_ms,
                 "for trying many servers on one machine: draw nothing, let each tile be grey and "
                 "take this long, asleep")
      ->check(CLI::Range(0.01, 10'000.0));
  app.add_option("--token-file", o.token_file,
                 "clients must present a token of this file: lines TOKEN [name=NAME] "
                 "[expires=2027-01-31T12:00:00Z] [scope=view,geometry,reference], and key=SECRET "
                 "for what mirage-token signs; read anew on SIGHUP");
  CLI::Option* cert =
      app.add_option("--tls-cert", o.endpoint.tls_cert, "certificate (PEM), read anew on SIGHUP");
  CLI::Option* key = app.add_option("--tls-key", o.endpoint.tls_key, "its private key (PEM)");
  cert->needs(key);
  key->needs(cert);
  app.add_option(
      "--allow-origin", o.endpoint.allow_origin,
      "a browser's page may come from this origin, too (default: from this server's own host)");
  CLI::Option* web = app.add_option(
      "--web", o.endpoint.web,
      "folder of the viewer's page for browsers, served at / (default: beside this program, where "
      "scripts/web or an installation put it)");
  app.add_flag("--no-web", no_web, "serve no page to browsers")->excludes(web);
  app.add_option("--drain-s", o.endpoint.drain_s,
                 "once told to stop: for how long what was asked for is still served")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  app.add_flag("--no-geometry", no_geometry,
               "never send meshes, nor full renders unless --references; tiles still show what is "
               "visible, with its relief");
  app.add_flag("--no-reference", no_reference, "refuse full renders for comparison");
  app.add_flag("--references", references,
               "full renders for comparison also where others can reach the server, or with "
               "--no-geometry, although their depth tells it (default: on this machine's own "
               "addresses)")
      ->excludes("--no-reference");
  app.add_flag("--no-view", no_view, "no picture of the whole scene to begin with");
  app.add_option("--shadows", shadows, "the sun's shadows: on or off")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app.add_option("--max-clients", o.session.max_clients, "clients at a time")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option(
      "--admin", admin,
      "[HOST:]PORT for who operates the server: /metrics, /healthz and /readyz; the host "
      "is this machine unless it is said; port 0 takes any free one and logs it");
  app.add_flag("--metrics", o.endpoint.metrics, "serve GET /metrics (Prometheus text)");
  CLI::Option* explain = app.add_flag("--explain", o.explain,
                                      "print what each object needs and what is left out; exit");
  app.add_flag("--json", o.json, "with --explain: as JSON")->needs(explain);
  CLI::Option* prove = app.add_flag(
      "--prove", o.prove, "with --explain: draw with and without, compare every byte, time both");
  prove->needs(explain);
  app.add_option("--prove-cells", o.prove_cells, "with --prove: view cells of each object")
      ->needs(prove)
      ->check(CLI::Range(1, 26))
      ->capture_default_str();
  app.add_option("--prove-objects", o.prove_objects,
                 "with --prove: objects of those that have the same left out")
      ->needs(prove)
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  bool check = false;
  app.add_flag("--check-config", check,
               "read options, configuration and token file, say whether they are good, and exit");
  app.add_flag("--doctor", o.doctor,
               "look whether this machine can serve with these options: devices, limits, port, "
               "cache, tokens, certificate, store, one tile; say so line by line, and exit");
  std::string log_format = "text";
  app.add_option("--log-format", log_format, "of the log on standard error: text, or JSON a line")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  if (log_format == "json") o.log_format = LogFormat::kJson;
  if (o.list_devices || !o.write_environment.empty()) return -1;
  if (o.scene.empty() && o.doctor) o.scene = "builtin:knot";
  if (o.scene.empty()) {
    return fail(make_error(ErrorId::kUsage, "no SCENE given", "try mirage-server builtin:forest"));
  }
  Result<ListenAddress> address = parse_listen(listen);
  if (!address) return fail(address.error());
  o.endpoint.address = address.take();
  if (!admin.empty()) {
    const bool port_only = admin.find_first_not_of("0123456789") == std::string::npos;
    Result<ListenAddress> operators = parse_listen(port_only ? "127.0.0.1:" + admin : admin);
    if (!operators) return fail(operators.error());
    o.endpoint.admin = operators.take();
  }
  if (!o.port_file.empty() && !o.endpoint.address.socket_path.empty()) {
    return fail(make_error(ErrorId::kUsage, "--port-file: a unix socket has no port"));
  }
  if (!store.empty()) {
    Result<StoreAddress> parsed = parse_store_url(store);
    if (!parsed) return fail(parsed.error());
    o.store = parsed.take();
  }
  if (!o.token_file.empty()) {
    Result<Access> access = Access::read(o.token_file);
    if (!access) return fail(access.error());
    o.session.access = access.take();
  }
  if (!no_web && o.endpoint.web.empty()) o.endpoint.web = web_folder_beside_program();
  o.session.geometry = !no_geometry;
  // A full render has depth from anywhere, which is geometry; and it takes the renderer for long.
  const bool unasked = !no_geometry && is_loopback(o.endpoint.address);
  o.session.reference = references || (unasked && !no_reference);
  o.session.view = !no_view;
  o.shadows = shadows == "on";
  if (const std::optional<TileCodec> only = codec_from_name(codec)) {
    o.session.codecs = {*only};
    if (is_lossy(*only)) o.session.codecs.push_back(TileCodec::kZstd);
  }
  if (check) {
    std::puts("the configuration is good");
    return 0;
  }
  return -1;
}

}  // namespace mirage
