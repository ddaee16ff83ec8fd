// Tile benchmarks: the cost of making tiles. They compare the whole server with a bare GL loop, and
// levels of detail with the whole mesh.
#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "protocol/impostor/capture.h"
#include "server/render/gpu_scene.h"
#include "server/render/tile_shot.h"
#include "shaders/gl/egl_context.h"
#include "shaders/gl/renderer.h"
#include "tests/bench/bench.h"
#include "tests/bench/server_path.h"
#include "tests/bench/stages.h"

namespace mirage::bench {
namespace {

// Draws what tiles are drawn from, with the same shaders, and nothing else.
class BareLoop {
 public:
  static Result<std::unique_ptr<BareLoop>> create(std::shared_ptr<const PreparedScene> scene) {
    Result<gl::EglContext> egl = gl::EglContext::create("auto");
    if (!egl) return egl.error();
    auto loop = std::make_unique<BareLoop>();
    loop->egl_ = egl.take();
    loop->scene_ = std::make_unique<GpuScene>(std::move(scene));
    loop->meshes_ = std::make_unique<gl::MeshPass>(gl::MeshOutput::kColor);
    loop->target_ =
        gl::RenderTarget(3 * 256, 3 * 256, {gl::color_format(loop->scene_->prepared->blends())},
                         GL_DEPTH_COMPONENT32F);
    if (!loop->target_.ok()) return make_error(ErrorId::kGraphicsGl, "no target of the bare loop");
    return loop;
  }
  void draw(const std::vector<TileJob>& jobs, bool whole_mesh) {
    egl_.make_current();
    glEnable(GL_FRAMEBUFFER_SRGB);
    glEnable(GL_DEPTH_CLAMP);
    glEnable(GL_SCISSOR_TEST);
    target_.bind();
    for (const TileJob& job : jobs) {
      const ObjectDescription& object = scene_->prepared->objects[job.key.object];
      const Capture capture(job.key.cell, job.key.distance, object.radius,
                            tile_edge(job.key.size_class));
      const int samples = object.needs & kNeedAlphaMask ? 3 : 2;
      const int edge = static_cast<int>(capture.edge) * samples;
      glViewport(0, 0, edge, edge);
      glScissor(0, 0, edge, edge);
      glDepthMask(GL_TRUE);
      glClearColor(0, 0, 0, 0);
      glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      const glm::dvec3 eye = glm::dvec3(object.center) + capture.eye();
      meshes_->begin(capture_projection(capture), gl::light_block(job.lighting, glm::vec3(eye)));
      const gl::MeshInstance one = gl::mesh_instance({}, eye, 0);
      const gl::GpuMesh& mesh = whole_mesh ? scene_->meshes[job.key.object]
                                           : scene_->mesh_for_tile(job.key.object, capture);
      for (const bool blended : {false, true}) {
        meshes_->draw(mesh, scene_->materials(), scene_->images, &one, 1, blended);
      }
      meshes_->end();
    }
    glFinish();
  }
  const GpuScene& scene() const { return *scene_; }

 private:
  gl::EglContext egl_;
  std::unique_ptr<GpuScene> scene_;
  std::unique_ptr<gl::MeshPass> meshes_;
  gl::RenderTarget target_;
};

Result<std::vector<Row>> whole_server(const Conditions& conditions) {
  Result<std::shared_ptr<const PreparedScene>> scene = load_scene("builtin:forest?trees=60");
  if (!scene) return scene.error();
  Stages stages;
  if (const Result<void> started = stages.start(*scene); !started) return started.error();
  Result<std::unique_ptr<BareLoop>> bare = BareLoop::create(*scene);
  if (!bare) return bare.error();
  constexpr std::size_t kTiles = 64;
  std::uint32_t ours = 0, theirs = 0;
  const Pair pair = in_turn(
      Time::kWall, conditions.quick ? 5 : 15,
      [&] { stages.make(tiles_of(**scene, kTiles, 128, ours)); },
      [&] { (*bare)->draw(tiles_of(**scene, kTiles, 128, theirs), false); });
  const auto rate = [&](double seconds) {
    return fmt::format("{:.0f} tiles/s", static_cast<double>(kTiles) / seconds);
  };
  Result<std::vector<Row>> rows = server_path(conditions);
  if (!rows) return rows.error();
  rows->insert(rows->begin(),
               {"server, asks in, encoded 128-texel tiles out (forest)", rate(pair.ours_s),
                "bare GL loop: " + rate(pair.beside_s), pair.ratio, ">= 0.9", pair.ratio >= 0.9,
                pair.spread_pct, "same levels of detail, shaders, samples and format; wall time"});
  return rows;
}

// Returns the PSNR over covered texels, alpha included, between tiles drawn from levels and from
// the whole mesh.
Result<double> psnr_of_levels(const BareLoop& loop, const std::vector<TileJob>& jobs,
                              const GpuScene& whole) {
  Result<TileShooter> lean = TileShooter::create(loop.scene(), 2, {}, true);
  Result<TileShooter> full = TileShooter::create(whole, 2, {}, true);
  if (!lean) return lean.error();
  if (!full) return full.error();
  double squares = 0, count = 0;
  for (const TileJob& job : jobs) {
    const std::optional<TileShot> a = lean->shoot(job), b = full->shoot(job);
    if (!a || !b) return make_error(ErrorId::kGraphicsGl, "no target for a tile");
    for (std::size_t i = 0; i < a->color.size(); i += 4) {
      if (a->color[i + 3] == 0 && b->color[i + 3] == 0) continue;
      for (std::size_t k = 0; k < 4; ++k) {
        const double d = static_cast<double>(a->color[i + k]) - b->color[i + k];
        squares += d * d;
        count += 1;
      }
    }
  }
  return 10 * std::log10(255.0 * 255.0 / std::max(squares / count, 1e-9));
}

Result<std::vector<Row>> levels(const Conditions& conditions) {
  Result<std::shared_ptr<const PreparedScene>> scene =
      load_scene("builtin:knot?tubular=1000&radial=50");
  if (!scene) return scene.error();
  Result<std::unique_ptr<BareLoop>> loop = BareLoop::create(*scene);
  if (!loop) return loop.error();
  std::uint32_t serial = 0;
  const std::vector<TileJob> jobs = tiles_of(**scene, 24, 128, serial);
  const Pair pair = in_turn(
      Time::kCpu, conditions.quick ? 5 : 15, [&] { (*loop)->draw(jobs, false); },
      [&] { (*loop)->draw(jobs, true); });
  auto bare = std::make_shared<PreparedScene>(**scene);
  for (ObjectDescription& object : bare->objects) object.lods.clear();
  const GpuScene whole(bare);
  const Result<double> psnr = psnr_of_levels(**loop, jobs, whole);
  if (!psnr) return psnr.error();
  const Capture capture(jobs[0].key.cell, jobs[0].key.distance, (*scene)->objects[0].radius, 128);
  const auto& lods = (*scene)->objects[0].lods;
  const std::size_t lod = lod_for_tile(lods, capture);
  const auto ms = [&](double s) { return fmt::format("{:.1f} ms a tile", 1000 * s / 24); };
  return std::vector<Row>{{"tile of 128 texels by level of detail (knot)", ms(pair.ours_s),
                           "whole mesh: " + ms(pair.beside_s), pair.ratio, ">= 5, PSNR >= 34 dB",
                           pair.ratio >= 5 && *psnr >= 34, pair.spread_pct,
                           fmt::format("{} of {} triangles, PSNR {:.1f} dB; CPU time",
                                       lods[lod].triangles, (*scene)->scene.triangles(), *psnr)}};
}

}  // namespace

std::vector<Bench> tile_benches() {
  return {{"server", "throughput beside a bare GL loop; CPU time of a tile besides drawing",
           whole_server},
          {"levels", "tiles from levels of detail beside the whole mesh", levels}};
}

}  // namespace mirage::bench
