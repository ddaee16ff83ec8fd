#include "server/stage/stand_in_stage.h"

#include <fmt/format.h>

#include <chrono>

#include "server/stage/render_options.h"
#include "server/tile/reference_encode.h"
#include "server/tile/stage_queues.h"

namespace mirage {
namespace {

std::shared_ptr<const PagePixels> grey_page(std::uint32_t edge) {
  const std::size_t texels = std::size_t{edge} * edge;
  auto page = std::make_shared<PagePixels>();
  page->width = page->height = static_cast<int>(edge);
  page->rgba.assign(texels * 4, 255);
  page->depth.assign(texels, 128);
  page->surface.assign(texels * 4, 128);
  return page;
}

}  // namespace

StandInStage::StandInStage(StageQueues& queues, std::function<void()> wake)
    : queues_(queues), wake_(std::move(wake)) {}

StandInStage::~StandInStage() { join(); }

void StandInStage::join() {
  if (thread_.joinable()) thread_.join();
}

std::string StandInStage::start(const RenderOptions& options) {
  thread_ = std::thread([this, tile_ms = options.stand_in_ms] { run(tile_ms); });
  return fmt::format("none: {:g} ms asleep a tile", options.stand_in_ms);
}

void StandInStage::run(double tile_ms) {
  const auto one_at_a_time = [](bool& first) {
    return [&first](std::uint32_t) { return std::exchange(first, false); };
  };
  for (;;) {
    bool first = true;
    std::optional<TileQueue::Work> work = queues_.tiles.take({one_at_a_time(first)}, true);
    if (!work) return;
    if (const auto* view = std::get_if<ViewJob>(&*work)) {
      queues_.completions.push(FinishedView{view->id, nullptr});
      wake_();
    } else if (const auto* full = std::get_if<ReferenceJob>(&*work)) {
      queues_.completions.push(refused_reference(full->session, full->request_id));
      wake_();
    } else if (auto* batch = std::get_if<std::vector<TileJob>>(&*work)) {
      for (TileJob& job : *batch) {
        const std::int64_t start = queues_.clock.now_us();
        std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(tile_ms));
        ++queues_.counters.tiles_rendered;
        RenderedTile tile;
        tile.page = grey_page(tile_edge(job.key.size_class));
        tile.queue_us = static_cast<std::uint32_t>(start - job.queued_us);
        tile.render_us = static_cast<std::uint32_t>(queues_.clock.now_us() - start);
        tile.job = std::move(job);
        queues_.rendered.push(std::move(tile));
      }
    }
  }
}

}  // namespace mirage
