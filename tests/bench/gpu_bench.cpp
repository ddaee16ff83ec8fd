// GPU benchmarks: tiles, read-back and uploads on a graphics card, over page edge, batch and ring
// depth. A software renderer only shows that they run, because there they measure the processor.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>

#include "client/draw/impostor_atlas.h"
#include "client/hold/tile_cache.h"
#include "protocol/codec/atlas_planes.h"
#include "server/render/gpu_scene.h"
#include "server/render/readback_ring.h"
#include "server/render/tile_page.h"
#include "shaders/gl/egl_context.h"
#include "tests/bench/bench.h"
#include "tests/bench/stages.h"

namespace mirage::bench {
namespace {

constexpr std::uint32_t kTileEdge = 128;
constexpr int kSupersample = 2;  // as on the server

struct Setting {
  int page_edge = 512;    ///< texels
  std::size_t batch = 0;  ///< tiles a page; 0: as many as fit
  std::size_t ring = 2;   ///< pages in flight
};
constexpr Setting kDefault;  // the server's: as many tiles a page as fit

double seconds_of(const std::function<void()>& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

std::size_t fit(int page_edge) {
  const auto row = static_cast<std::size_t>(page_edge) / kTileEdge;
  return row * row;
}

/// Draws pages and reads them back, as the render stage does, and nothing else.
class PageLoop {
 public:
  static Result<std::unique_ptr<PageLoop>> create(const std::string& device) {
    Result<std::shared_ptr<const PreparedScene>> scene =
        load_scene("builtin:forest?trees=60&clutter=0");
    if (!scene) return scene.error();
    auto loop = std::make_unique<PageLoop>();
    Result<gl::EglContext> egl = gl::EglContext::create(device);
    if (!egl) return egl.error();
    loop->egl_ = egl.take();
    loop->scene_ = std::make_unique<GpuScene>(*scene);
    Result<TilePageRenderer> pages = TilePageRenderer::create(*loop->scene_, kSupersample);
    if (!pages) return pages.error();
    loop->pages_ = std::make_unique<TilePageRenderer>(pages.take());
    if (Result<void> warm = loop->pages_->warm_up(kDefault.page_edge); !warm) return warm.error();
    return loop;
  }

  std::string device() const { return egl_.description(); }

  /// Draws pages of this setting until `tiles` are there. Returns false if no target can be made.
  bool draw(const Setting& setting, std::size_t tiles) {
    ReadbackRing ring(setting.ring);
    std::uint32_t serial = 0;
    const std::vector<TileJob> jobs = tiles_of(*scene_->prepared, tiles, kTileEdge, serial);
    const std::size_t most = setting.batch > 0 ? setting.batch : fit(setting.page_edge);
    for (std::size_t next = 0; next < tiles;) {
      PagePacker packer(setting.page_edge);
      PendingPage page;
      while (next < tiles && page.jobs.size() < most && packer.add(kTileEdge)) {
        page.jobs.push_back(jobs[next++]);
        page.places.emplace_back(packer.places().back().x, packer.places().back().y);
      }
      page.width = packer.used().x;
      page.height = packer.used().y;
      const gl::RenderTarget* target = pages_->render(page.jobs, packer);
      if (!target) return false;
      ring.start(*target, std::move(page));
      while (ring.full()) ring.collect(true);
    }
    while (!ring.empty()) ring.collect(true);
    return true;
  }

  /// Returns tiles a second; 0: not possible.
  double rate(const Setting& setting, std::size_t tiles, int rounds) {
    if (!draw(setting, 1)) return 0;  // makes the targets
    std::vector<double> rates;
    for (int i = 0; i < rounds; ++i) {
      rates.push_back(static_cast<double>(tiles) / seconds_of([&] { draw(setting, tiles); }));
    }
    return middle(rates).median;
  }

  /// Returns bytes a second from the card, for empty pages.
  double readback_rate(int edge, std::size_t depth, int pages) {
    const gl::RenderTarget target(edge, edge, {GL_SRGB8_ALPHA8, GL_R8}, 0);
    if (!target.ok()) return 0;
    ReadbackRing ring(depth);
    const double s = seconds_of([&] {
      for (int i = 0; i < pages; ++i) {
        PendingPage page;
        page.width = page.height = edge;
        ring.start(target, std::move(page));
        while (ring.full()) ring.collect(true);
      }
      while (!ring.empty()) ring.collect(true);
    });
    return 5.0 * edge * edge * pages / s;
  }

  /// Returns bytes a second to the card, for planes of lit tiles into the client's atlas. Error
  /// kGraphicsGl.
  Result<double> upload_rate(int tiles) {
    constexpr int kEdge = 1024;
    Result<ImpostorAtlas> atlas = ImpostorAtlas::create(kEdge, 1);
    if (!atlas) return atlas.error();
    TileRecord record;
    record.crop = {0, 0, kTileEdge - 2, kTileEdge - 2};
    AtlasPlanes planes;
    planes.color.assign(std::size_t{kTileEdge} * kTileEdge * 4, 128);
    planes.depth.assign(std::size_t{kTileEdge} * kTileEdge, 128);
    const int row = kEdge / static_cast<int>(kTileEdge);
    Result<void> done;
    const double s = seconds_of([&] {
      for (int i = 0; i < tiles && done.ok(); ++i) {
        record.slot = {0, i % row * static_cast<int>(kTileEdge),
                       i / row % row * static_cast<int>(kTileEdge), kTileEdge, kTileEdge};
        done = atlas->upload(record, planes);
      }
      glFinish();
    });
    if (!done) return done.error();
    return 5.0 * kTileEdge * kTileEdge * tiles / s;
  }

 private:
  gl::EglContext egl_;
  std::unique_ptr<GpuScene> scene_;
  std::unique_ptr<TilePageRenderer> pages_;
};

std::vector<Setting> settings(bool quick) {
  std::vector<Setting> out;
  const std::vector<int> edges =
      quick ? std::vector{512, 1024} : std::vector{512, 1024, 2048, 4096};
  const std::vector<std::size_t> rings =
      quick ? std::vector<std::size_t>{1, 2} : std::vector<std::size_t>{1, 2, 3, 4};
  for (const int edge : edges) {
    for (const std::size_t batch : {fit(edge) / 16, fit(edge) / 4, fit(edge)}) {
      for (const std::size_t ring : rings) out.push_back({edge, batch, ring});
    }
  }
  return out;
}

Result<std::vector<Row>> sweep(const Conditions& conditions) {
  Result<std::unique_ptr<PageLoop>> made = PageLoop::create(conditions.device);
  if (!made) return made.error();
  PageLoop& loop = **made;
  const int rounds = conditions.quick ? 1 : 5;
  const std::size_t least = conditions.quick ? 16 : 1024;  // tiles a round
  const double usual = loop.rate(kDefault, least, rounds);
  if (usual <= 0) return make_error(ErrorId::kGraphicsGl, "no page can be drawn");
  std::vector<Row> rows;
  for (const Setting& s : settings(conditions.quick)) {
    const double rate = loop.rate(s, std::max(least, s.batch), rounds);
    if (rate <= 0) continue;  // larger than the device allows
    rows.push_back({fmt::format("tiles of {}: page {}, batch {}, ring {}", kTileEdge, s.page_edge,
                                s.batch, s.ring),
                    fmt::format("{:.0f} tiles/s", rate),
                    fmt::format("as the server is: {:.0f}", usual), rate / usual, ""});
  }
  const auto best = std::max_element(rows.begin(), rows.end(),
                                     [](const Row& a, const Row& b) { return a.ratio < b.ratio; });
  if (best != rows.end()) best->note = "the best of all on " + loop.device();
  for (const int edge : {512, 2048}) {
    const int pages = conditions.quick ? 4 : 64;
    const double one = loop.readback_rate(edge, 1, pages), two = loop.readback_rate(edge, 2, pages);
    if (one <= 0 || two <= 0) continue;
    rows.push_back({fmt::format("read-back of pages of {}, ring 2", edge),
                    fmt::format("{:.2f} GB/s", two * 1e-9),
                    fmt::format("ring 1: {:.2f} GB/s", one * 1e-9), two / one, ""});
  }
  const Result<double> up = loop.upload_rate(conditions.quick ? 64 : 4096);
  if (!up) return up.error();
  constexpr double kFrameBudget = 8 << 20;  // the viewer's --upload-kb
  const double ms = 1000 * kFrameBudget / *up;
  rows.push_back({"client: 8 MiB of tiles into the atlas, a frame's budget",
                  fmt::format("{:.2f} ms", ms), "frame at 60 a second: 16.7 ms", 16.7 / ms, ""});
  return rows;
}

}  // namespace

Result<bool> is_hardware(const std::string& device) {
  const Result<gl::EglContext> egl = gl::EglContext::create(device);
  if (!egl) return egl.error();
  return !egl->software();
}

std::vector<Bench> gpu_benches() {
  return {
      {"gpu", "tiles, read-back, uploads on a graphics card by page, batch, ring", sweep, true}};
}

}  // namespace mirage::bench
