#include "server/stage/render_stage.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <future>

#include "server/base/counters.h"
#include "server/render/gpu_scene.h"
#include "server/render/readback_ring.h"
#include "server/render/reference_renderer.h"
#include "server/render/scene_shadow.h"
#include "server/render/tile_page.h"
#include "server/stage/render_options.h"
#include "server/tile/stage_queues.h"
#include "server/tile/tile_queue.h"
#include "shaders/gl/egl_context.h"
#include "shaders/gl/health.h"
#include "shaders/gl/program.h"

namespace mirage {
namespace {

/// Everything the GL thread owns; made and destroyed on it.
struct GlWorld {
  std::unique_ptr<GpuScene> scene;
  std::unique_ptr<SceneShadow> shadow;  ///< none without --shadows
  std::unique_ptr<TilePageRenderer> pages;
  std::unique_ptr<ReferenceRenderer> references;

  std::size_t scene_bytes() const {
    return scene->gpu_bytes() + (shadow ? shadow->gpu_bytes() : 0);
  }
};

Result<GlWorld> make_world(std::shared_ptr<const PreparedScene> scene,
                           const RenderOptions& options) {
  GlWorld world;
  world.scene = std::make_unique<GpuScene>(std::move(scene));
  if (options.shadows) {
    Result<SceneShadow> shadow = SceneShadow::create(*world.scene);
    if (!shadow) return shadow.error();
    world.shadow = std::make_unique<SceneShadow>(shadow.take());
  }
  Result<TilePageRenderer> pages =
      TilePageRenderer::create(*world.scene, options.supersample, world.shadow.get());
  if (!pages) return pages.error();
  world.pages = std::make_unique<TilePageRenderer>(pages.take());
  const std::size_t budget = options.gpu_mb << 20, taken = world.scene_bytes();
  if (taken > budget) {
    return make_error(ErrorId::kGraphicsGl,
                      "the scene takes " + std::to_string(taken >> 20) +
                          " MB of graphics memory, more than " + std::to_string(options.gpu_mb),
                      "--gpu-mb takes more");
  }
  world.pages->limit(budget - taken, options.ring);
  if (Result<void> warm = world.pages->warm_up(options.page_edge); !warm) return warm.error();
  Result<ReferenceRenderer> references =
      ReferenceRenderer::create(*world.scene, world.shadow.get());
  if (!references) return references.error();
  world.references = std::make_unique<ReferenceRenderer>(references.take());
  if (Result<void> warm = world.references->warm_up(); !warm) return warm.error();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    return make_error(ErrorId::kGraphicsGl, "GL error " + std::to_string(error) + " at start");
  }
  return world;
}

/// Draws what the tile queue holds until it is closed, or GL fails.
class RenderLoop {
 public:
  RenderLoop(StageQueues& queues, const std::function<void()>& wake, GlWorld world,
             const RenderOptions& options, bool software)
      : queues_(queues),
        wake_(wake),
        world_(std::move(world)),
        options_(options),
        software_(software),
        ring_(options.ring) {
    queues_.counters.gpu_scene_bytes = world_.scene_bytes();
    note_memory(0);
  }

  /// Error kGraphicsGl: what was under way is not handed on.
  Result<void> run();

 private:
  Result<void> draw(std::vector<TileJob> jobs, const PagePacker& packer);
  Result<void> draw(ViewJob job);
  Result<void> draw(const ReferenceJob& job);
  /// What is done; waits for one page if `wait`.
  Result<void> collect(bool wait);
  void hand_over(const PendingPage& page, const std::shared_ptr<const PagePixels>& pixels);
  /// No targets can be made for them.
  void refuse(const std::vector<TileJob>& jobs);
  void announce(Completion done);

  std::size_t target_bytes() const { return world_.pages->gpu_bytes() + ring_.gpu_bytes(); }
  void note_memory(std::size_t more);
  bool fits_memory(const SceneShot& shot);

  StageQueues& queues_;
  const std::function<void()>& wake_;
  GlWorld world_;
  const RenderOptions options_;
  const bool software_;
  ReadbackRing ring_;
};

Result<void> RenderLoop::run() {
  Counters& counters = queues_.counters;
  for (;;) {
    PagePacker packer(options_.page_edge);
    const auto fits = [&](std::uint32_t edge) { return packer.add(edge); };
    std::optional<TileQueue::Work> work = queues_.tiles.take(fits, ring_.empty());
    if (!work && ring_.empty()) return {};
    queues_.rendering_since_us = queues_.clock.now_us();
    Result<void> drawn;
    if (work && std::holds_alternative<ViewJob>(*work)) {
      drawn = draw(std::get<ViewJob>(std::move(*work)));
    } else if (work && std::holds_alternative<ReferenceJob>(*work)) {
      drawn = draw(std::get<ReferenceJob>(*work));
    } else if (work) {
      drawn = draw(std::get<std::vector<TileJob>>(std::move(*work)), packer);
    }
    if (!drawn) return drawn;
    counters.shader_programs_after_ready = gl::programs_compiled() - counters.shader_programs;
    // Collect what is done; wait only when the ring is full or nothing else is there to do.
    if (Result<void> collected = collect(!work); !collected) return collected;
    queues_.rendering_since_us = 0;
  }
}

Result<void> RenderLoop::collect(bool wait) {
  while (!ring_.empty()) {
    const std::optional<ReadbackRing::Collected> page = ring_.collect(wait || ring_.full());
    if (!page) break;
    if (!page->pixels) return page->pixels.error();
    hand_over(page->info, *page->pixels);
  }
  return {};
}

void RenderLoop::hand_over(const PendingPage& page,
                           const std::shared_ptr<const PagePixels>& pixels) {
  const std::int64_t now = queues_.clock.now_us();
  const auto tiles = static_cast<std::int64_t>(page.jobs.size());
  const auto share = static_cast<std::uint32_t>((now - page.started_us) / tiles);
  for (std::size_t i = 0; i < page.jobs.size(); ++i) {
    RenderedTile tile{page.jobs[i], pixels, page.places[i].first, page.places[i].second, 0, share};
    tile.queue_us = static_cast<std::uint32_t>(page.started_us - tile.job.queued_us);
    queues_.rendered.push(std::move(tile));
  }
}

Result<void> RenderLoop::draw(std::vector<TileJob> jobs, const PagePacker& packer) {
  PendingPage page;
  page.jobs = std::move(jobs);
  page.started_us = queues_.clock.now_us();
  page.width = packer.used().x;
  page.height = packer.used().y;
  for (std::size_t i = 0; i < page.jobs.size(); ++i) {
    page.places.emplace_back(packer.places()[i].x, packer.places()[i].y);
  }
  page.surface = world_.pages->writes_surface(page.jobs);
  const gl::RenderTarget* target = world_.pages->render(page.jobs, packer);
  if (!target) {
    refuse(page.jobs);
    return {};
  }
  if (Result<void> healthy = gl::check_health("drawing a page"); !healthy) return healthy;
  ++queues_.counters.pages_rendered;
  queues_.counters.tiles_rendered += page.jobs.size();
  ring_.start(*target, std::move(page));
  note_memory(0);
  return {};
}

Result<void> RenderLoop::draw(ViewJob job) {
  if (software_ && !job.home) job.shot.supersample = 1;
  Result<SceneFrame> frame = make_error(ErrorId::kGraphicsGl, "a view is over --gpu-mb");
  if (fits_memory(job.shot)) frame = world_.references->draw(job.shot);
  if (Result<void> healthy = gl::check_health("drawing a view"); !healthy) return healthy;
  if (frame) {
    ++queues_.counters.views_rendered;
    queues_.rendered.push(RenderedView{job.id, job.shot.camera, frame.take()});
    return {};
  }
  spdlog::warn("{}", frame.error().line());
  announce(FinishedView{job.id, nullptr});
  return {};
}

Result<void> RenderLoop::draw(const ReferenceJob& job) {
  Result<Bytes> reply = make_error(ErrorId::kGraphicsGl, "a full render is over --gpu-mb");
  if (fits_memory(job.shot)) reply = world_.references->render(job);
  if (Result<void> healthy = gl::check_health("a full render"); !healthy) return healthy;
  ++queues_.counters.references_rendered;
  if (!reply) {
    spdlog::warn("{}", reply.error().line());
    wire::RefusedT refused;
    refused.request_id = job.request_id;
    refused.reason = wire::RefusalReason::TooLarge;
    reply = encode_message(std::move(refused));
  }
  announce(FinishedReference{job.session, reply.take()});
  return {};
}

void RenderLoop::refuse(const std::vector<TileJob>& jobs) {
  for (const TileJob& job : jobs) announce(TooLargeTile{job.id});
}

void RenderLoop::announce(Completion done) {
  queues_.completions.push(std::move(done));
  wake_();
}

void RenderLoop::note_memory(std::size_t more) {
  Counters& counters = queues_.counters;
  counters.gpu_target_bytes = target_bytes();
  counters.gpu_most_bytes = std::max<std::uint64_t>(
      counters.gpu_most_bytes, counters.gpu_scene_bytes + target_bytes() + more);
}

bool RenderLoop::fits_memory(const SceneShot& shot) {
  const std::size_t more = world_.references->gpu_bytes(shot);
  const std::size_t all = queues_.counters.gpu_scene_bytes + target_bytes() + more;
  if (all > options_.gpu_mb << 20) return false;
  note_memory(more);
  return true;
}

}  // namespace

RenderStage::RenderStage(StageQueues& queues, std::function<void()> wake)
    : queues_(queues), wake_(std::move(wake)) {}

RenderStage::~RenderStage() { join(); }

void RenderStage::join() {
  if (thread_.joinable()) thread_.join();
}

Result<std::string> RenderStage::start(std::shared_ptr<const PreparedScene> scene,
                                       const RenderOptions& options) {
  auto promise = std::make_shared<std::promise<Result<std::string>>>();
  std::future<Result<std::string>> ready = promise->get_future();
  thread_ = std::thread([this, scene, options, promise] {
    run(scene, options, [promise](Result<std::string> r) { promise->set_value(std::move(r)); });
  });
  return ready.get();
}

void RenderStage::run(std::shared_ptr<const PreparedScene> scene, RenderOptions options,
                      std::function<void(Result<std::string>)> ready) {
  Result<gl::EglContext> context = gl::EglContext::create(options.device);
  if (!context) return ready(context.error());
  Result<GlWorld> world = make_world(std::move(scene), options);
  if (!world) return ready(world.error());
  queues_.counters.shader_programs = gl::programs_compiled();
  RenderLoop loop(queues_, wake_, world.take(), options, context->software());
  ready(context->description());
  const Result<void> ended = loop.run();
  if (ended) return;
  spdlog::error("{}", ended.error().line());
  queues_.completions.push(RendererFailure{ended.error()});
  wake_();
}

}  // namespace mirage
