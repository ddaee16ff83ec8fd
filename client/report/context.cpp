#include "client/report/context.h"

#include <spdlog/fmt/fmt.h>

#include "client/host/server_process.h"
#include "client/report/session_run.h"
#include "client/report/truth_source.h"
#include "client/scene/scene_view.h"
#include "report_commit.h"

namespace mirage {

std::string source_commit() { return MIRAGE_COMMIT; }
std::string hex64(std::uint64_t value) { return fmt::format("{:016x}", value); }

Result<SessionRunner*> Context::graphics() {
  if (!runner) {
    Result<std::unique_ptr<SessionRunner>> made = SessionRunner::create(options.device);
    if (!made) return made.error();
    runner = made.take();
  }
  return runner.get();
}

Result<OpenScene*> Context::open(const std::string& name) {
  std::unique_ptr<OpenScene>& scene = scenes[key_of(name)];
  if (scene) return scene.get();
  auto made = std::make_unique<OpenScene>();
  made->url = options.url;
  if (made->url.empty()) {
    Result<std::unique_ptr<ServerProcess>> server = ServerProcess::start(name, options.device);
    if (!server) return server.error();
    made->server = server.take();
    made->url = made->server->url();
  }
  Result<std::unique_ptr<TruthSource>> truth = TruthSource::open(made->url);
  if (!truth) return truth.error();
  made->truth = truth.take();
  made->name = made->truth->scene().name;
  scene = std::move(made);
  return scene.get();
}

Result<OpenScene*> Context::open_own(const std::string& part, const std::string& name) {
  const Result<OpenScene*> opened = open(name);
  if (opened || !options.scene.empty() || !options.url.empty()) return opened;
  omit(part, name, opened.error().line());
  return static_cast<OpenScene*>(nullptr);
}

std::vector<std::string> Context::scenes_or(const std::vector<std::string>& own) const {
  if (!options.url.empty()) return {options.url};
  return options.scene.empty() ? own : std::vector<std::string>{options.scene};
}

void Context::plot(const std::string& name, const std::vector<Panel>& panels, int columns,
                   const std::string& caption) {
  const Result<std::string> svg = plotter.draw(name, panels, columns);
  if (svg) return page.figure(*svg, caption);
  omit("plots", name, svg.error().line());
}

OpenScene::~OpenScene() = default;

std::string OpenScene::path() const {
  constexpr std::size_t kSingleThing = 10;
  const bool single = truth->scene().instances.size() < kSingleThing;
  return single ? "builtin:orbit" : "builtin:walk";
}

void Context::close(const std::string& name) { scenes.erase(key_of(name)); }

}  // namespace mirage
