#include "server/stage/slow_work.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <new>

#include "protocol/base/limits.h"
#include "protocol/impostor/tile_key.h"
#include "server/render/reference_renderer.h"
#include "server/render/tile_page.h"
#include "server/stage/gl_world.h"
#include "server/tile/reference_encode.h"
#include "server/tile/stage_queues.h"
#include "shaders/gl/health.h"

namespace mirage {
namespace {

// Samples shaded per slice. The software value takes 2 to 4 ms on two cores. The GPU value is not
// measured yet; a slice should take long compared with the wait for its end.
constexpr double kSoftwareSlice = 64 * 1024, kGpuSlice = 8 * 1024 * 1024;

/// Returns the smallest edge, texels, of tiles that need more than two slices.
std::uint32_t smallest_slow_edge(double slice_samples, int supersample) {
  std::uint32_t edge = 1;
  while (std::pow(double{1} * edge * supersample, 2) <= 2 * slice_samples) edge *= 2;
  return edge;
}

}  // namespace

SlowWork::SlowWork(StageQueues& queues, const std::function<void()>& wake, GlWorld& world,
                   const RenderOptions& options, bool software)
    : queues_(queues),
      wake_(wake),
      world_(world),
      most_bytes_(options.gpu_mb << 20),
      software_(software),
      slice_samples_(software ? kSoftwareSlice : kGpuSlice),
      slow_edge_(smallest_slow_edge(slice_samples_, options.supersample)) {}

bool SlowWork::has_room() const { return (!under_way() || idle()) && queues_.slow.size() == 0; }

bool SlowWork::idle() const {
  const auto* full = std::get_if<ReferenceJob>(&job_);
  return full && full->idle;
}

void SlowWork::announce(Completion done) {
  queues_.completions.push(std::move(done));
  wake_();
}

void SlowWork::drop() {
  job_ = std::monostate{};
  world_.references->drop();
  world_.pages->drop_slow();
}

Result<void> SlowWork::begin_picture(const SceneShot& shot) {
  const std::size_t bytes = world_.references->gpu_bytes(shot);
  if (world_.scene_bytes() + world_.pages->gpu_bytes() + bytes > most_bytes_) {
    return make_error(ErrorId::kGraphicsGl, "a picture of the scene is over --gpu-mb");
  }
  return world_.references->begin(shot, slice_samples_);
}

Result<void> SlowWork::begin_tile(const TileJob& job) {
  if (world_.pages->begin_slow(job, slice_samples_)) return {};
  return make_error(ErrorId::kGraphicsGl, "there is no room for a tile");
}

Result<void> SlowWork::begin(Job job) {
  if (idle()) {
    queues_.tiles.submit(std::move(std::get<ReferenceJob>(job_)));
    drop();
  }
  if (auto* view = std::get_if<ViewJob>(&job); view && software_ && !view->home) {
    view->shot.supersample = 1;
  }
  if (std::holds_alternative<ReferenceJob>(job)) ++queues_.counters.references_rendered;
  job_ = std::move(job);
  started_us_ = queues_.clock.now_us();
  Result<void> begun;
  try {
    const auto* tile = std::get_if<TileJob>(&job_);
    const auto* view = std::get_if<ViewJob>(&job_);
    begun = tile   ? begin_tile(*tile)
            : view ? begin_picture(view->shot)
                   : begin_picture(std::get<ReferenceJob>(job_).shot);
  } catch (const std::bad_alloc&) {
    begun = make_error(ErrorId::kGraphicsGl, "there is no memory for it");
  }
  if (Result<void> healthy = gl::check_health("beginning slow work"); !healthy) return healthy;
  if (!begun) refuse(begun.error());
  return {};
}

void SlowWork::refuse(const Error& why) {
  spdlog::warn("refused: {}", why.line());
  if (const auto* tile = std::get_if<TileJob>(&job_)) {
    announce(TooLargeTile{tile->id});
  } else if (const auto* view = std::get_if<ViewJob>(&job_)) {
    announce(FinishedView{view->id, nullptr});
  } else {
    const ReferenceJob& full = std::get<ReferenceJob>(job_);
    if (full.picture) {
      announce(FinishedPicture{full.picture->key, nullptr});
    } else {
      announce(refused_reference(full.session, full.request_id));
    }
  }
  drop();
}

Result<void> SlowWork::draw_slice() {
  if (std::holds_alternative<ReferenceJob>(job_) && !queues_.tiles.reference_wanted()) {
    drop();
    return {};
  }
  std::shared_ptr<const PagePixels> pixels;
  std::optional<SceneFrame> frame;
  try {
    if (std::holds_alternative<TileJob>(job_)) {
      pixels = world_.pages->draw_slow_slice();
    } else {
      frame = world_.references->draw_slice();
    }
  } catch (const std::bad_alloc&) {
    refuse(make_error(ErrorId::kGraphicsGl, "there is no memory for it"));
  }
  if (Result<void> healthy = gl::check_health("a slice of slow work"); !healthy) return healthy;
  if (pixels) hand_over(std::move(pixels));
  if (frame) hand_over(std::move(*frame));
  return {};
}

void SlowWork::hand_over(std::shared_ptr<const PagePixels> pixels) {
  ++queues_.counters.pages_rendered;
  ++queues_.counters.tiles_rendered;
  RenderedTile done{std::get<TileJob>(std::move(job_)), std::move(pixels), 0, 0, 0, 0};
  done.queue_us = static_cast<std::uint32_t>(started_us_ - done.job.queued_us);
  done.render_us = static_cast<std::uint32_t>(queues_.clock.now_us() - started_us_);
  drop();
  queues_.slow.push(std::move(done));
}

void SlowWork::hand_over(SceneFrame frame) {
  if (auto* view = std::get_if<ViewJob>(&job_)) {
    ++queues_.counters.views_rendered;
    RenderedView done{view->id, view->shot.camera, view->shot.time_s, std::move(frame)};
    drop();
    queues_.slow.push(std::move(done));
    return;
  }
  ReferenceJob& full = std::get<ReferenceJob>(job_);
  RenderedReference done{full.session, full.request_id, full.shot.camera.width,
                         full.shot.camera.height, std::move(frame)};
  done.render_us = static_cast<std::uint32_t>(queues_.clock.now_us() - started_us_);
  done.picture = std::move(full.picture);
  drop();
  queues_.slow.push(std::move(done));
}

}  // namespace mirage
