#include "server/stage/render_stage.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <future>

#include "server/base/counters.h"
#include "server/render/readback_ring.h"
#include "server/render/reference_renderer.h"
#include "server/render/tile_page.h"
#include "server/stage/gl_world.h"
#include "server/stage/render_options.h"
#include "server/stage/slow_work.h"
#include "server/tile/stage_queues.h"
#include "server/tile/tile_queue.h"
#include "shaders/gl/egl_context.h"
#include "shaders/gl/health.h"
#include "shaders/gl/program.h"

namespace mirage {
namespace {

/// Draws the content of the tile queue until it is closed or GL fails.
class RenderLoop {
 public:
  RenderLoop(StageQueues& queues, const std::function<void()>& wake, GlWorld world,
             const RenderOptions& options, bool software)
      : queues_(queues),
        wake_(wake),
        world_(std::move(world)),
        options_(options),
        slow_(queues, wake, world_, options, software),
        ring_(options.ring) {
    note_scene();
  }

  /// Runs the loop. Errors: kGraphicsGl, work under way is lost; kInternal: no memory for a page of
  /// small tiles.
  Result<void> run_within_memory() {
    try {
      return run();
    } catch (const std::bad_alloc&) {
      return make_error(ErrorId::kInternal, "there is no memory left");
    }
  }

 private:
  Result<void> run();
  Result<void> draw(TileQueue::Work work, const PagePacker& packer);
  Result<void> draw(std::vector<TileJob> jobs, const PagePacker& packer);
  /// Hands over finished pages; if `wait`, waits for one.
  Result<void> collect(bool wait);
  void hand_over(const PendingPage& page, const std::shared_ptr<const PagePixels>& pixels);
  void note_scene();
  void note_memory();

  StageQueues& queues_;
  const std::function<void()>& wake_;
  GlWorld world_;
  const RenderOptions options_;
  SlowWork slow_;
  ReadbackRing ring_;
};

Result<void> RenderLoop::run() {
  Counters& counters = queues_.counters;
  for (;;) {
    PagePacker packer(options_.page_edge);
    TileQueue::Room room;
    room.fits = [&](std::uint32_t edge) { return packer.add(edge); };
    room.slow_edge = slow_.slow_edge();
    room.slow = [&] { return slow_.has_room(); };
    room.idle = !slow_.under_way();
    std::optional<TileQueue::Work> work =
        queues_.tiles.take(room, ring_.empty() && !slow_.under_way());
    if (!work && queues_.tiles.closed()) slow_.drop();
    if (!work && ring_.empty() && !slow_.under_way()) {
      if (queues_.tiles.closed()) return {};
      continue;
    }
    queues_.rendering_since_us = queues_.clock.now_us();
    const bool any = work.has_value();
    if (any) {
      if (Result<void> drawn = draw(std::move(*work), packer); !drawn) return drawn;
    }
    counters.shader_programs_after_ready = gl::programs_compiled() - counters.shader_programs;
    // The loop waits for a page only if the ring is full, if there is no other work, or before a
    // slice, which would delay the page further.
    if (Result<void> got = collect(!any || slow_.under_way()); !got) return got;
    if (slow_.under_way() && !(any && slow_.idle())) {
      if (Result<void> drawn = slow_.draw_slice(); !drawn) return drawn;
    }
    note_memory();
    queues_.rendering_since_us = 0;
  }
}

Result<void> RenderLoop::draw(TileQueue::Work work, const PagePacker& packer) {
  if (auto* view = std::get_if<ViewJob>(&work)) return slow_.begin(std::move(*view));
  if (auto* full = std::get_if<ReferenceJob>(&work)) return slow_.begin(std::move(*full));
  if (std::holds_alternative<TileQueue::UploadLevels>(work)) {
    Result<void> uploaded = world_.upload_levels(options_);
    note_scene();
    return uploaded;
  }
  auto& jobs = std::get<std::vector<TileJob>>(work);
  if (tile_edge(jobs.front().key.size_class) >= slow_.slow_edge()) {
    return slow_.begin(std::move(jobs.front()));
  }
  return draw(std::move(jobs), packer);
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
    for (const TileJob& job : page.jobs) queues_.completions.push(TooLargeTile{job.id});
    wake_();
    return {};
  }
  if (Result<void> healthy = gl::check_health("drawing a page"); !healthy) return healthy;
  ++queues_.counters.pages_rendered;
  queues_.counters.tiles_rendered += page.jobs.size();
  ring_.start(*target, std::move(page));
  return {};
}

void RenderLoop::note_scene() {
  queues_.counters.gpu_scene_bytes = world_.scene_bytes();
  note_memory();
}

void RenderLoop::note_memory() {
  Counters& counters = queues_.counters;
  counters.gpu_target_bytes =
      world_.pages->gpu_bytes() + ring_.gpu_bytes() + world_.references->gpu_bytes();
  counters.gpu_most_bytes = std::max<std::uint64_t>(
      counters.gpu_most_bytes, counters.gpu_scene_bytes + counters.gpu_target_bytes);
}

}  // namespace

RenderStage::RenderStage(StageQueues& queues, std::function<void()> wake)
    : queues_(queues), wake_(std::move(wake)) {}

RenderStage::~RenderStage() { join(); }

void RenderStage::join() {
  if (thread_.joinable()) thread_.join();
}

Result<Renderer> RenderStage::start(std::shared_ptr<const PreparedScene> scene,
                                    const RenderOptions& options) {
  auto promise = std::make_shared<std::promise<Result<Renderer>>>();
  std::future<Result<Renderer>> ready = promise->get_future();
  thread_ = std::thread([this, scene, options, promise] {
    run(scene, options, [promise](Result<Renderer> r) { promise->set_value(std::move(r)); });
  });
  return ready.get();
}

void RenderStage::run(std::shared_ptr<const PreparedScene> scene, RenderOptions options,
                      std::function<void(Result<Renderer>)> ready) {
  Result<gl::EglContext> context = gl::EglContext::create(options.device);
  if (!context) return ready(context.error());
  Result<GlWorld> world = make_world(std::move(scene), options);
  if (!world) return ready(world.error());
  queues_.counters.shader_programs = gl::programs_compiled();
  RenderLoop loop(queues_, wake_, world.take(), options, context->software());
  ready(Renderer{context->description(), context->software()});
  const Result<void> ended = loop.run_within_memory();
  if (ended) return;
  spdlog::error("{}", ended.error().line());
  queues_.completions.push(RendererFailure{ended.error()});
  wake_();
}

}  // namespace mirage
