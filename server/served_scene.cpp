#include "server/served_scene.h"

#include <spdlog/spdlog.h>

#include "server/options.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/session.h"
#include "server/source/directory_source.h"
#include "server/source/shared_store.h"
#include "server/stage/pipeline.h"
#include "server/stage/render_profile.h"

namespace mirage {

struct ServedScene::Parts {
  std::shared_ptr<const PreparedScene> scene;
  std::optional<DirectorySource> directory;
  std::unique_ptr<TileSource> shared;
  std::optional<Pipeline> pipeline;
  std::optional<SessionHub> hub;
};

ServedScene::ServedScene() : parts_(std::make_unique<Parts>()) {}
ServedScene::~ServedScene() { stop(); }

Result<std::shared_ptr<const PreparedScene>> load_served(const ServerOptions& options,
                                                         CacheDirectory* cache) {
  const auto tell = [](const std::string& line) { spdlog::info("loading: {}", line); };
  Result<std::shared_ptr<const PreparedScene>> scene =
      load_scene(options.scene, {.keep_imported = options.prove,
                                 .strict = options.strict,
                                 .choice = options.choice,
                                 .megabytes = options.scene_mb,
                                 .environment = options.environment,
                                 .studio = options.look == "studio",
                                 .cache = cache,
                                 .progress = tell});
  if (!scene) return scene;
  for (const std::string& warning : (*scene)->scene.warnings) spdlog::warn("scene: {}", warning);
  return scene;
}

Result<std::unique_ptr<ServedScene>> ServedScene::start(const ServerOptions& options,
                                                        CacheDirectory* cache, const Clock& clock,
                                                        std::function<void()> wake) {
  std::unique_ptr<ServedScene> out(new ServedScene);
  Parts& parts = *out->parts_;
  Result<std::shared_ptr<const PreparedScene>> scene = load_served(options, cache);
  if (!scene) return scene.error();
  parts.scene = scene.take();
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
  parts.pipeline.emplace(clock, options.cache_mb << 20, std::move(sources), std::move(wake));
  const Result<std::string> renderer = parts.pipeline->start(parts.scene, render, options.encoders);
  if (!renderer) return renderer.error();
  session.renderer = *renderer;
  session.profile = render_profile(*renderer, render.supersample).hash();
  parts.hub.emplace(parts.scene, std::move(session), parts.pipeline->queues);
  return out;
}

void ServedScene::stop() {
  if (parts_->pipeline) parts_->pipeline->stop();
}

const PreparedScene& ServedScene::scene() const { return *parts_->scene; }
SessionHub& ServedScene::hub() { return *parts_->hub; }
StageQueues& ServedScene::queues() { return parts_->pipeline->queues; }
int ServedScene::encoders() const { return parts_->pipeline->encoders(); }

}  // namespace mirage
