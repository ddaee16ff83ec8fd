// Impostors against the full render of the same build: the fidelity protocol of the field
// (FIELD.md: 512 x 512, 24 Fibonacci directions, tight field of view, grey background).

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "client/core/geometric_error.h"
#include "tests/gl/bench.h"

namespace mirage::test {
namespace {

int dirs() { const char* s = std::getenv("DIRS"); return s ? atoi(s) : 6; }

TEST(Proto, Table) {
  const char* which = std::getenv("MODEL");
  const std::string spec = which ? which : "builtin:knot";
  const bool albedo = spec.find("tree") != std::string::npos;
  auto bench = Bench::create(spec, albedo ? BenchLight::kAlbedo : BenchLight::kLit);
  ASSERT_TRUE(bench);
  const char* rs = std::getenv("RADII");
  const double radii = rs ? atof(rs) : 4;
  for (const double off : {0.0, 5.0, 10.0, 20.0}) {
    if (std::getenv("QUICK") && off != 5 && off != 10) continue;
    for (const DrawMethod m : {DrawMethod::kQuad, DrawMethod::kHull, DrawMethod::kDepth}) {
      if (std::getenv("QUICK") && m != DrawMethod::kDepth) continue;
      MeasureMean psnr, iou, ssim;
      double ms = 0;
      for (int i = 0; i < dirs(); ++i) {
        TileCache cache = bench->make_cache();
        const glm::dvec3 d = fibonacci_direction(i * 24 / dirs(), 24);
        const TileRecordPtr tile = bench->tile_for(bench->camera(radii, d), cache);
        ASSERT_TRUE(tile);
        const Camera c = bench->camera(radii, turned(d, off, 2.4 * i));
        bench->draw(c, {tile}, m);
        glFinish();
        const auto t0 = std::chrono::steady_clock::now();
        const auto drawn = bench->picture(c, {tile}, m);
        ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - t0).count();
        const auto truth = bench->truth(c, 4);
        const FieldFidelity f = field_fidelity({512, 512, truth.data()}, {512, 512, drawn.data()});
        psnr.add(f.psnr_db); iou.add(f.iou); ssim.add(f.ssim);
        if (i == 1 && std::getenv("DUMP")) {
          std::vector<std::uint8_t> row(512 * 3 * 512 * 3);
          for (int y = 0; y < 512; ++y) for (int x = 0; x < 512; ++x) for (int k = 0; k < 3; ++k) {
            std::size_t p = std::size_t((y * 512 + x) * 4 + k);
            row[std::size_t((y * 1536 + x) * 3 + k)] = drawn[p];
            row[std::size_t((y * 1536 + 512 + x) * 3 + k)] = truth[p];
            row[std::size_t((y * 1536 + 1024 + x) * 3 + k)] = static_cast<std::uint8_t>(std::min(255, 2 * std::abs(drawn[p] - truth[p])));
          }
          char name[200];
          snprintf(name, 200, "%s_%d_%g.ppm", std::getenv("DUMP"), (int)m, off);
          FILE* fp = fopen(name, "wb"); fprintf(fp, "P6 1536 512 255\n"); fwrite(row.data(), 1, row.size(), fp); fclose(fp);
        }
      }
      std::printf("%5.1fr %4.0f deg method %d: PSNR %.2f SSIM %.4f IoU %.4f  %.1f ms\n", radii, off, (int)m,
                  psnr.mean().value_or(0), ssim.mean().value_or(0), iou.mean().value_or(0), ms / dirs());
    }
  }
}

}  // namespace
}  // namespace mirage::test
