#include "server/render_stage.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <future>

#include "server/render/gpu_scene.h"
#include "server/render/readback_ring.h"
#include "server/render/reference_renderer.h"
#include "server/render/tile_page.h"
#include "server/rendered_keys.h"
#include "shaders/gl/egl_context.h"
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

void RenderStage::refuse(const std::vector<TileJob>& jobs) {
  for (const TileJob& job : jobs) {
    Completion none;
    none.id = job.id;
    none.refused = true;
    queues_.completions.push(std::move(none));
  }
  wake_();
}

void RenderStage::run(std::shared_ptr<const PreparedScene> scene, RenderOptions options,
                      std::function<void(Result<std::string>)> ready) {
  Result<gl::EglContext> context = gl::EglContext::create(options.device);
  if (!context) return ready(context.error());
  Result<GlWorld> world = make_world(std::move(scene), options);
  if (!world) return ready(world.error());
  queues_.counters.shader_programs = gl::programs_compiled();
  ready(context->description());

  const bool software = context->software();
  RenderedKeys rendered_before;
  ReadbackRing ring(options.ring);
  const std::size_t scene_bytes = world->scene_bytes();
  queues_.counters.gpu_scene_bytes = scene_bytes;
  const auto target_bytes = [&] { return world->pages->gpu_bytes() + ring.gpu_bytes(); };
  const auto note_memory = [&](std::size_t more) {
    queues_.counters.gpu_target_bytes = target_bytes();
    queues_.counters.gpu_most_bytes =
        std::max<std::uint64_t>(queues_.counters.gpu_most_bytes, scene_bytes + target_bytes() + more);
  };
  note_memory(0);
  const auto fits_memory = [&](const SceneShot& shot) {
    const std::size_t more = world->references->gpu_bytes(shot);
    if (scene_bytes + target_bytes() + more > options.gpu_mb << 20) return false;
    note_memory(more);
    return true;
  };
  const auto hand_over = [&](ReadbackRing::Collected page) {
    const std::int64_t now = queues_.clock.now_us();
    const auto tiles = static_cast<std::int64_t>(page.info.jobs.size());
    const auto share = static_cast<std::uint32_t>((now - page.info.started_us) / tiles);
    for (std::size_t i = 0; i < page.info.jobs.size(); ++i) {
      RenderedTile tile{page.info.jobs[i],          page.pixels, page.info.places[i].first,
                        page.info.places[i].second, 0,           share};
      tile.queue_us = static_cast<std::uint32_t>(page.info.started_us - tile.job.queued_us);
      queues_.rendered.push({std::make_shared<const RenderedTile>(std::move(tile)), nullptr});
    }
  };

  for (;;) {
    PagePacker packer(options.page_edge);
    const auto fits = [&](std::uint32_t edge) { return packer.add(edge); };
    std::optional<TileQueue::Work> work = queues_.tiles.take(fits, ring.empty());
    if (!work && ring.empty()) break;
    if (work && std::holds_alternative<ViewJob>(*work)) {
      ViewJob& job = std::get<ViewJob>(*work);
      if (software && !job.home) job.shot.supersample = 1;
      Result<SceneFrame> frame = make_error(ErrorId::kGraphicsGl, "a view is over --gpu-mb");
      if (fits_memory(job.shot)) frame = world->references->draw(job.shot);
      if (frame) {
        ++queues_.counters.views_rendered;
        queues_.rendered.push({nullptr, nullptr,
                        std::make_shared<const RenderedView>(
                            RenderedView{job.id, job.shot.camera, frame.take()})});
      } else {
        spdlog::warn("{}", frame.error().line());
        Completion none;
        none.view = job.id;
        queues_.completions.push(std::move(none));
        wake_();
      }
    } else if (work && std::holds_alternative<ReferenceJob>(*work)) {
      const ReferenceJob& job = std::get<ReferenceJob>(*work);
      Result<Bytes> reply = make_error(ErrorId::kGraphicsGl, "a full render is over --gpu-mb");
      if (fits_memory(job.shot)) reply = world->references->render(job);
      ++queues_.counters.references_rendered;
      if (!reply) {
        spdlog::warn("{}", reply.error().line());
        wire::RefusedT refused;
        refused.request_id = job.request_id;
        refused.reason = wire::RefusalReason::TooLarge;
        reply = encode_message(std::move(refused));
      }
      Completion done;
      done.session = job.session;
      done.message = reply.take();
      queues_.completions.push(std::move(done));
      wake_();
    } else if (work) {
      PendingPage page;
      page.jobs = std::move(std::get<std::vector<TileJob>>(*work));
      page.started_us = queues_.clock.now_us();
      page.width = packer.used().x;
      page.height = packer.used().y;
      for (std::size_t i = 0; i < page.jobs.size(); ++i) {
        page.places.emplace_back(packer.places()[i].x, packer.places()[i].y);
      }
      page.surface = world->pages->writes_surface(page.jobs);
      const gl::RenderTarget* target = world->pages->render(page.jobs, packer);
      if (target) {
        ++queues_.counters.pages_rendered;
        queues_.counters.tiles_rendered += page.jobs.size();
        for (const TileJob& job : page.jobs) {
          if (!rendered_before.add(job.id)) ++queues_.counters.tiles_rendered_twice;
        }
        ring.start(*target, std::move(page));
        note_memory(0);
      } else {
        refuse(page.jobs);
      }
    }
    queues_.counters.shader_programs_after_ready = gl::programs_compiled() - queues_.counters.shader_programs;
    // Collect what is done; wait only when the ring is full or nothing else is there to do.
    while (!ring.empty()) {
      std::optional<ReadbackRing::Collected> page = ring.collect(ring.full() || !work);
      if (!page) break;
      hand_over(std::move(*page));
    }
  }
}

}  // namespace mirage
