#include "tests/bench/drawn_tiles.h"

#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/readback_ring.h"
#include "server/render/tile_page.h"
#include "server/stage/render_options.h"
#include "shaders/gl/egl_context.h"
#include "tests/bench/stages.h"

namespace mirage::bench {
namespace {

bool has_tiles(const ObjectDescription& object, std::uint8_t channels) {
  if (channels == kRelitTile) return can_relight(object.needs);
  if (channels == kLayeredTile) return layered(object.needs);
  return true;
}

std::vector<TileJob> jobs_of(const PreparedScene& scene, std::size_t count, std::uint32_t edge,
                             std::uint8_t channels) {
  std::uint32_t serial = 0;
  std::vector<TileJob> out;
  for (TileJob& job : tiles_of(scene, count * scene.scene.objects.size(), edge, serial)) {
    if (out.size() == count) break;
    if (!has_tiles(scene.objects[job.key.object], channels)) continue;
    job.key.channels = channels;
    out.push_back(std::move(job));
  }
  return out;
}

}  // namespace

Result<std::vector<RenderedTile>> draw_tiles(const std::shared_ptr<const PreparedScene>& scene,
                                             std::size_t count, std::uint32_t edge,
                                             std::uint8_t channels) {
  const std::vector<TileJob> jobs = jobs_of(*scene, count, edge, channels);
  if (jobs.empty()) return make_error(ErrorId::kUsage, "no object of the scene has such tiles");
  return draw_jobs(scene, jobs, edge);
}

Result<std::vector<RenderedTile>> draw_jobs(const std::shared_ptr<const PreparedScene>& scene,
                                            const std::vector<TileJob>& jobs, std::uint32_t edge) {
  Result<gl::EglContext> egl = gl::EglContext::create("auto");
  if (!egl) return egl.error();
  const RenderOptions options;
  const GpuScene gpu(scene);
  Result<TilePageRenderer> pages = TilePageRenderer::create(gpu, options.supersample);
  if (!pages) return pages.error();
  std::vector<RenderedTile> out;
  for (auto next = jobs.begin(); next != jobs.end();) {
    PagePacker packer(options.page_edge);
    PendingPage page;
    while (next != jobs.end() && packer.add(edge)) page.jobs.push_back(*next++);
    page.width = packer.used().x;
    page.height = packer.used().y;
    page.surface = pages->writes_surface(page.jobs);
    const std::vector<TileJob> drawn = page.jobs;
    const gl::RenderTarget* const target = pages->render(drawn, packer);
    if (!target) return make_error(ErrorId::kGraphicsGl, "no target for a tile");
    ReadbackRing ring(1);
    ring.start(*target, std::move(page));
    const std::optional<ReadbackRing::Collected> read = ring.collect(true);
    if (!read->pixels) return read->pixels.error();
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      out.push_back({drawn[i], *read->pixels, packer.places()[i].x, packer.places()[i].y, 0, 0});
    }
  }
  return out;
}

}  // namespace mirage::bench
