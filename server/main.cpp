// mirage-server: the stages in flow order.
//
//   endpoint -> sessions -> pipeline (fetch, render, encode and image stage) -> sessions
//
// The network loop runs here; the stages have threads of their own.

#include <malloc.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>

#include "protocol/base/fail.h"
#include "protocol/base/resources.h"
#include "protocol/impostor/tile_key.h"
#include "server/base/cache_directory.h"
#include "server/base/huge_pages.h"
#include "server/base/log.h"
#include "server/chosen_scenes.h"
#include "server/doctor.h"
#include "server/net/endpoint.h"
#include "server/net/qr_code.h"
#include "server/options.h"
#include "server/prepare/prepared_scene.h"
#include "server/prove/explain.h"
#include "server/prove/need_proof.h"
#include "server/scene/environment/environment.h"
#include "server/scene/environment/environment_file.h"
#include "server/scene_reload.h"
#include "server/served_scene.h"
#include "server/service_manager.h"
#include "server/session/session.h"
#include "server/stage/pipeline.h"
#include "shaders/gl/egl_context.h"
#include "shaders/gl/health.h"
#include "shaders/gl/missing_gpu.h"

namespace mirage {
namespace {

// Longest time of the graphics thread on one piece of work, µs. Beyond it the thread counts as
// stuck, and the watchdog is no longer fed.
constexpr std::int64_t kLongestRenderUs = 30'000'000;

// Allocation size, bytes, from which freed memory returns to the system at once. Pictures are
// allocated on one thread and freed on another; by default the allocator would keep blocks of up to
// 32 MiB for each thread.
constexpr int kGivenBack = 1 << 20;

std::atomic<Endpoint*> running_endpoint{nullptr};

void on_terminate(int) {
  if (Endpoint* endpoint = running_endpoint.load()) endpoint->stop();
}

void on_hangup(int) {
  if (Endpoint* endpoint = running_endpoint.load()) endpoint->reload();
}

void warn_of(const Access& access) {
  for (const std::string& warning : access.warnings()) spdlog::warn("{}", warning);
}

// Reads the token file again. A wrong file changes nothing: the present tokens stay valid.
void read_tokens_anew(const std::string& path, SessionHub& hub) {
  if (path.empty()) return;
  Result<Access> access = Access::read(path);
  if (!access) {
    spdlog::error("{}; the tokens stay as they are", access.error().line());
    return;
  }
  warn_of(*access);
  hub.set_access(access.take());
  spdlog::info("tokens are read anew from '{}'", path);
}

int list_devices() {
  for (const gl::EglDevice& device : gl::list_egl_devices()) {
    std::printf("%-12s %s  %s\n", device.name.c_str(), device.usable ? "ok " : "no ",
                device.renderer.c_str());
  }
  return 0;
}

// Error kGraphicsDevice: the CPU draws. It names what keeps the card from drawing.
Result<void> require_gpu(const std::string& device) {
  const Result<gl::EglContext> context = gl::EglContext::create(device);
  if (!context) return context.error();
  if (!context->software()) return {};
  const Error why = gl::why_no_gpu(gl::gpu_facts()).front();
  return make_error(why.id,
                    "--require-gpu: " + context->description() + " draws on the CPU; " + why.text,
                    why.hint + "; --doctor tells more");
}

int write_surroundings(const ServerOptions& options) {
  std::vector<std::string> warnings;
  const Result<Equirect> image = surroundings(options.environment, warnings);
  for (const std::string& warning : warnings) spdlog::warn("{}", warning);
  if (!image) return fail(image.error());
  const Result<void> written = write_environment(*image, options.write_environment);
  return written ? 0 : fail(written.error());
}

// A thousand clients need a thousand descriptors; the soft limit is often 1024.
void raise_descriptor_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

// Values in the ready line end at the next space, except for the last.
std::string without_spaces(std::string text) {
  for (std::size_t at = text.find(' '); at != std::string::npos; at = text.find(' ', at)) {
    text.replace(at, 1, "%20");
  }
  return text;
}

Result<void> write_port(const std::string& path, int port) {
  if (path.empty()) return {};
  std::ofstream file(path);
  file << port << '\n';
  file.close();
  if (!file) return make_error(ErrorId::kIo, "cannot write port file '" + path + "'");
  return {};
}

void announce(const ServerOptions& options, ServedScene& served, int port) {
  const PreparedScene& scene = served.scene();
  const SessionHub& hub = served.hub();
  const std::string url = options.endpoint.address.url(!options.endpoint.tls_cert.empty(), port);
  std::printf("%s\n",
              fmt::format("ready url={} scene={} revision={:016x} profile={:016x} objects={} "
                          "instances={} triangles={} encoders={} gl={}",
                          without_spaces(url), without_spaces(options.scene), hub.revision(),
                          hub.options().profile, scene.objects.size(), scene.scene.instances.size(),
                          scene.scene.triangles(), served.encoders(), hub.options().renderer)
                  .c_str());
  if (!options.endpoint.web.empty() && options.log_format == LogFormat::kText) {
    const bool tls = !options.endpoint.tls_cert.empty();
    const std::vector<std::string> pages = page_urls(options.endpoint.address, tls, port);
    for (const std::string& page : pages) std::printf("open %s\n", page.c_str());
    // A phone can reach it, and a person sees the code.
    if (!pages.empty() && !is_loopback(options.endpoint.address) && isatty(STDOUT_FILENO)) {
      std::printf("%s", qr_code(pages.front()).c_str());
    }
  }
  std::fflush(stdout);
}

/// Returns the options for a scene that some viewers have chosen. Its tiles get a share of memory.
ServerOptions with_choice(ServerOptions options, const SceneChoice& choice) {
  options.choice = choice;
  options.cache_mb = std::max<std::size_t>(options.cache_mb / (options.choices + 1), 1);
  return options;
}

/// A running server, from the ready line to the last goodbye.
class Service {
 public:
  Service(const ServerOptions& options, CacheDirectory* cache)
      : options_(options),
        cache_(cache),
        reload_(options.scene, [this] { return load_whole(); }),
        chosen_(options.choices, clock_,
                {[this](const SceneChoice& choice) { return load(with_choice(options_, choice)); },
                 [this](std::unique_ptr<ServedScene> old) { reload_.retire(std::move(old)); }}) {}
  ~Service() {
    running_endpoint = nullptr;
    awake_ = nullptr;
    // The stages end before the endpoint they wake, however run() ended.
    chosen_.end();
    reload_.end();
    if (served_) served_->stop();
  }

  int run();

 private:
  EndpointHooks hooks();
  Result<std::unique_ptr<ServedScene>> load(const ServerOptions& options);
  /// Loads the options' scene. Viewers who have a picture already keep it until its levels of
  /// detail are made.
  Result<std::unique_ptr<ServedScene>> load_whole();
  void hangup();
  void tick();
  /// Replaces the served scene.
  void serve(std::unique_ptr<ServedScene> next);

  const ServerOptions& options_;
  CacheDirectory* const cache_;
  const SteadyClock clock_;
  std::atomic<Endpoint*> awake_{nullptr};
  const ServiceManager manager_;
  std::unique_ptr<ServedScene> served_;
  SceneReload reload_;
  ChosenScenes chosen_;
  std::optional<Endpoint> endpoint_;
};

Result<std::unique_ptr<ServedScene>> Service::load(const ServerOptions& options) {
  return ServedScene::start(options, cache_, clock_, [this] {
    if (Endpoint* endpoint = awake_.load()) endpoint->wake();
  });
}

Result<std::unique_ptr<ServedScene>> Service::load_whole() {
  Result<std::unique_ptr<ServedScene>> scene = load(options_);
  if (scene && awake_.load()) (*scene)->wait_for_levels();
  return scene;
}

EndpointHooks Service::hooks() {
  EndpointHooks out;
  out.reload = [this] { hangup(); };
  out.tick = [this] { tick(); };
  out.stopping = [this] { manager_.stopping(); };
  out.choose = [this](const SceneChoice& choice) { return chosen_.find(choice); };
  return out;
}

void Service::hangup() {
  manager_.reloading();
  read_tokens_anew(options_.token_file, served_->hub());
  chosen_.set_access(served_->hub().access());
  reload_.hangup();
  manager_.ready("serves " + options_.scene);
}

void Service::tick() {
  const StageQueues& queues = served_->queues();
  const std::int64_t since_us = queues.rendering_since_us;
  if (since_us == 0 || clock_.now_us() - since_us < kLongestRenderUs) manager_.alive();
  reload_.look();
  chosen_.look(*endpoint_, served_->hub().access());
  if (std::unique_ptr<ServedScene> next = reload_.take()) serve(std::move(next));
}

void Service::serve(std::unique_ptr<ServedScene> next) {
  if (next->hub().revision() == served_->hub().revision()) {
    spdlog::info("the scene is the same as before: nothing changes");
    return reload_.retire(std::move(next));
  }
  read_tokens_anew(options_.token_file, next->hub());
  next->hub().make_home_view();
  endpoint_->serve(next->hub(), next->queues());
  chosen_.clear();
  served_.swap(next);
  spdlog::info("serves revision {:016x} now, in place of {:016x}", served_->hub().revision(),
               next->hub().revision());
  reload_.retire(std::move(next));
}

int Service::run() {
  Result<std::unique_ptr<ServedScene>> first = reload_.load();
  if (!first) return fail(first.error());
  served_ = first.take();
  endpoint_.emplace(served_->hub(), served_->queues());
  if (const Result<void> listening = endpoint_->listen(options_.endpoint); !listening) {
    return fail(listening.error());
  }
  served_->hub().make_home_view();
  awake_ = &*endpoint_;
  endpoint_->wake();  // for what came before
  running_endpoint = &*endpoint_;
  std::signal(SIGTERM, on_terminate);
  std::signal(SIGINT, on_terminate);
  std::signal(SIGHUP, on_hangup);
  std::signal(SIGPIPE, SIG_IGN);
  if (const Result<void> written = write_port(options_.port_file, endpoint_->port()); !written) {
    return fail(written.error());
  }
  announce(options_, *served_, endpoint_->port());
  manager_.ready("serves " + options_.scene);
  const Result<void> ended = endpoint_->run(hooks());
  awake_ = nullptr;
  const Counters& counters = served_->queues().counters;
  spdlog::info("stopped: {} tiles rendered, {} from the store, {} merged",
               counters.tiles_rendered.load(), counters.store_hits.load(),
               counters.tiles_merged.load());
  return ended ? 0 : fail(ended.error());
}

int explain(const ServerOptions& options, const std::shared_ptr<const PreparedScene>& scene) {
  std::optional<Proof> proof;
  if (options.prove) {
    ProofOptions how;
    how.cells = options.prove_cells;
    how.objects_per_class = options.prove_objects;
    how.supersample = options.render.supersample;
    how.device = options.render.device;
    how.progress = [](const std::string& line) { spdlog::info("{}", line); };
    Result<Proof> proven = prove_needs(scene, how);
    if (!proven) return fail(proven.error());
    proof = proven.take();
  }
  const auto tell = options.json ? explain_json : explain_text;
  std::fputs(tell(*scene, options.shadows, proof ? &*proof : nullptr).c_str(), stdout);
  const bool holds = !proof || proof->total.differing_components == 0;
  return static_cast<int>(holds ? ExitCode::kOk : ExitCode::kComparison);
}

// Reads the scene as far as it can be wrong, and serves nothing. Warnings go to the log.
int check_scene(const ServerOptions& options) {
  const Result<Scene> scene = import_scene(options.scene, {.strict = options.strict,
                                                           .megabytes = options.scene_mb,
                                                           .environment = options.environment});
  if (!scene) return fail(scene.error());
  for (const std::string& warning : scene->warnings) spdlog::warn("scene: {}", warning);
  std::puts("the configuration is good");
  return 0;
}

int run(int argc, char** argv) {
  ServerOptions options;
  if (const int code = parse_options(argc, argv, options); code >= 0) return code;
  Result<void> enough = require_addresses(kRendererMb);
  if (enough) enough = require_threads();
  if (!enough) return fail(enough.error());
  if (options.list_devices) return list_devices();
  if (options.doctor) return run_doctor(options);
  set_up_log(options.log_format);
  warn_of(options.session.access);
  if (options.require_gpu) {
    if (const Result<void> gpu = require_gpu(options.render.device); !gpu) return fail(gpu.error());
  }
  if (!options.write_environment.empty()) return write_surroundings(options);
  mallopt(M_MMAP_THRESHOLD, kGivenBack);
  raise_descriptor_limit();
  std::optional<CacheDirectory> directory;
  if (!options.cache_dir.empty()) {
    directory.emplace(options.cache_dir, options.cache_dir_mb << 20,
                      options.cache_read_only ? CacheDirectory::Use::kReadOnly
                                              : CacheDirectory::Use::kReadAndWrite);
  }
  CacheDirectory* const cache = directory ? &*directory : nullptr;
  if (options.check_config) return check_scene(options);
  if (!options.explain) return Service(options, cache).run();
  Result<std::shared_ptr<const PreparedScene>> scene = load_served(options, cache);
  if (!scene) return fail(scene.error());
  return explain(options, scene.take());
}

}  // namespace
}  // namespace mirage

int main(int argc, char** argv) {
  mirage::use_huge_pages(argv);
  return mirage::run_program(
      [&] { return mirage::gl::exit_without_leaks(mirage::run(argc, argv)); });
}
