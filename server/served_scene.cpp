#include "server/served_scene.h"

#include <malloc.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <atomic>
#include <optional>
#include <thread>

#include "server/options.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/session.h"
#include "server/source/directory_source.h"
#include "server/source/shared_store.h"
#include "server/stage/pipeline.h"
#include "server/stage/render_profile.h"

namespace mirage {

namespace {

// Free bytes at the end of a heap from which they return to the system. While a scene is loaded,
// pictures and trees of one mesh after another take that memory again; to get it anew took half of
// the time of loading.
constexpr int kKept = 1 << 20, kKeptLoading = 64 << 20;
constexpr int kBehindPictures = 10;  // niceness added: pictures that viewers wait for go first

SceneLoadOptions load_options(const ServerOptions& options, CacheDirectory* cache) {
  return {.keep_imported = options.prove,
          .strict = options.strict,
          .choice = options.choice,
          .megabytes = options.scene_mb,
          .environment = options.environment,
          .studio = options.look == "studio",
          .home = options.home,
          .cache = cache,
          .progress = [](const std::string& line) { spdlog::info("loading: {}", line); }};
}

void tell_warnings(const PreparedScene& scene) {
  for (const std::string& warning : scene.scene.warnings) spdlog::warn("scene: {}", warning);
}

}  // namespace

struct ServedScene::Parts {
  std::shared_ptr<PreparedScene> scene;
  std::optional<DirectorySource> directory;
  std::unique_ptr<TileSource> shared;
  std::optional<Pipeline> pipeline;
  std::optional<SessionHub> hub;
  std::atomic<bool> stopped{false};
  std::thread levels;  ///< makes the levels of detail

  void make_levels(const SceneLoadOptions& options, const std::function<void()>& wake);
};

void ServedScene::Parts::make_levels(const SceneLoadOptions& options,
                                     const std::function<void()>& wake) {
  // On Linux, of this thread and those it starts. An error changes nothing.
  [[maybe_unused]] const int niceness = nice(kBehindPictures);
  StageTimes times;
  mirage::make_levels(*scene, options, &stopped);
  if (stopped) return;
  times.done("levels of detail");
  mallopt(M_TRIM_THRESHOLD, kKept);
  malloc_trim(0);
  spdlog::info("made in {}", times.words());
  pipeline->queues.tiles.levels_made();
  pipeline->queues.completions.push(LevelsMade{});
  wake();
}

ServedScene::ServedScene() : parts_(std::make_unique<Parts>()) {}
ServedScene::~ServedScene() { stop(); }

Result<std::shared_ptr<const PreparedScene>> load_served(const ServerOptions& options,
                                                         CacheDirectory* cache) {
  Result<std::shared_ptr<const PreparedScene>> scene =
      load_scene(options.scene, load_options(options, cache));
  if (scene) tell_warnings(**scene);
  return scene;
}

Result<std::unique_ptr<ServedScene>> ServedScene::start(const ServerOptions& options,
                                                        CacheDirectory* cache, const Clock& clock,
                                                        std::function<void()> wake) {
  mallopt(M_TRIM_THRESHOLD, kKeptLoading);
  std::unique_ptr<ServedScene> out(new ServedScene);
  Parts& parts = *out->parts_;
  const SceneLoadOptions load = load_options(options, cache);
  Result<std::shared_ptr<PreparedScene>> scene = load_without_levels(options.scene, load);
  if (!scene) return scene.error();
  parts.scene = scene.take();
  tell_warnings(*parts.scene);
  spdlog::info("loaded in {}", parts.scene->load_times.words());
  TileSources sources;
  if (cache) sources.push_back(&parts.directory.emplace(*cache));
  if (options.store) {
    Result<std::unique_ptr<TileSource>> store = open_shared_store(*options.store, clock);
    if (!store) return store.error();
    parts.shared = store.take();
    sources.push_back(parts.shared.get());
  }
  RenderOptions render = options.render;
  SessionOptions session = options.session;
  session.choices = options.choices > 0;
  session.shadows = render.shadows = options.shadows && parts.scene->has_casters();
  parts.pipeline.emplace(clock, options.cache_mb << 20, std::move(sources), wake);
  parts.pipeline->queues.tiles.wait_for_levels();
  const Result<std::string> renderer = parts.pipeline->start(parts.scene, render, options.encoders);
  if (!renderer) return renderer.error();
  session.renderer = *renderer;
  session.profile = render_profile(*renderer, render.supersample).hash();
  parts.hub.emplace(parts.scene, std::move(session), parts.pipeline->queues);
  parts.levels = std::thread([&parts, load, wake] { parts.make_levels(load, wake); });
  return out;
}

void ServedScene::wait_for_levels() {
  if (parts_->levels.joinable()) parts_->levels.join();
}

void ServedScene::stop() {
  parts_->stopped = true;
  if (parts_->pipeline) parts_->pipeline->stop();  // nobody takes what is made now
  wait_for_levels();
}

const PreparedScene& ServedScene::scene() const { return *parts_->scene; }
SessionHub& ServedScene::hub() { return *parts_->hub; }
StageQueues& ServedScene::queues() { return parts_->pipeline->queues; }
int ServedScene::encoders() const { return parts_->pipeline->encoders(); }

}  // namespace mirage
