// Tiles shaded by the server, and tiles shaded by the client, against the mesh of the same object
// and against the full render. Figures are printed; limits are the measured values, rounded down.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "tests/gl/bench.h"
#include "tests/support/data_folder.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kLitEdge = Bench::kSize;
constexpr int kLitDirections = 8;

using Picture = std::vector<std::uint8_t>;

// Returns CIE L*a*b* of an sRGB texel under D65.
glm::dvec3 lab(const std::uint8_t* rgba) {
  glm::dvec3 linear;
  for (int c = 0; c < 3; ++c) {
    const double v = rgba[c] / 255.0;
    linear[c] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  const glm::dvec3 xyz(
      (0.4124564 * linear.r + 0.3575761 * linear.g + 0.1804375 * linear.b) / 0.95047,
      0.2126729 * linear.r + 0.7151522 * linear.g + 0.0721750 * linear.b,
      (0.0193339 * linear.r + 0.1191920 * linear.g + 0.9503041 * linear.b) / 1.08883);
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  return {116 * f(xyz.y) - 16, 500 * (f(xyz.x) - f(xyz.y)), 200 * (f(xyz.y) - f(xyz.z))};
}

// Returns the mean CIE76 difference over the pixels that either covers.
double mean_delta_e(const Picture& a, const Picture& b) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); i += 4) {
    if (a[i + 3] < 128 && b[i + 3] < 128) continue;
    sum += glm::length(lab(&a[i]) - lab(&b[i]));
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

struct Agreement {
  MeasureMean psnr;
  double delta_e = 0;
  void add(const Picture& truth, const Picture& test) {
    psnr.add(field_fidelity({kLitEdge, kLitEdge, truth.data()}, {kLitEdge, kLitEdge, test.data()})
                 .psnr_db);
    delta_e += mean_delta_e(truth, test) / kLitDirections;
  }
  void print(const char* model, const char* what) const {
    std::printf("[ FIGURES  ] %-14s %-22s PSNR %.1f dB, mean dE %.2f\n", model, what,
                psnr.mean().value_or(0), delta_e);
  }
};

// The object is turned and scaled, so that normals left in the object's space would show.
Similarity placed() {
  Similarity s;
  s.position = {3, -2, 5};
  s.rotation = glm::angleAxis(1.9f, glm::normalize(glm::vec3(1, 2, -0.5f)));
  s.scale = 1.7f;
  return s;
}

// Returns a sun from elsewhere, a lamp beside the object and a spot from above.
Lighting other_light(const Bench& bench) {
  const glm::dvec3 center = bench.instance().center;
  const double r = bench.instance().radius;
  Lighting out;
  out.ambient = glm::vec3(0.1f, 0.12f, 0.15f);
  Light sun;
  sun.color = glm::vec3(0.5f, 0.45f, 0.35f);
  sun.direction = glm::normalize(glm::vec3(1, -0.6f, 0.8f));
  Light lamp;
  lamp.kind = LightKind::kPoint;
  lamp.position = center + glm::dvec3(-1.6, 0.4, 0.9) * r;
  lamp.color = glm::vec3(0.3f, 0.5f, 0.9f) * static_cast<float>(r * r);
  lamp.range = static_cast<float>(4 * r);
  Light spot;
  spot.kind = LightKind::kSpot;
  spot.position = center + glm::dvec3(0.2, 3, 0) * r;
  spot.direction = {0, -1, 0};
  spot.color = glm::vec3(3.0f) * static_cast<float>(r * r);
  spot.cos_inner = 0.97f;
  spot.cos_outer = 0.9f;
  out.lights = {sun, lamp, spot};
  return out;
}

void keep(const std::string& name, const std::vector<Picture>& panels) {
  const char* folder = std::getenv("MIRAGE_FIDELITY_PICTURES");
  if (!folder) return;
  std::ofstream file(std::string(folder) + "/" + name + ".ppm", std::ios::binary);
  file << "P6 " << panels.size() * kLitEdge << " " << kLitEdge << " 255\n";
  for (std::size_t y = 0; y < kLitEdge; ++y) {
    for (const Picture& panel : panels) {
      for (std::size_t i = y * kLitEdge * 4; i < (y + 1) * kLitEdge * 4; ++i) {
        if (i % 4 != 3) file.put(static_cast<char>(panel[i]));
      }
    }
  }
}

// Fog is drawn over the picture. The tile stays the same, and impostor, mesh and full render agree
// with fog as well, near and far.
TEST(Fog, IsInThePictureAndNotInTheTile) {
  std::vector<std::uint64_t> bytes;
  for (const float density : {0.0f, 0.06f}) {
    const std::unique_ptr<Bench> bench =
        Bench::create("builtin:knot", BenchLight::kLit, placed(), density);
    ASSERT_TRUE(bench);
    for (const double radii : {4.0, 12.0}) {
      const Camera c = bench->camera(radii, fibonacci_direction(3, kLitDirections));
      TileCache cache = bench->make_cache();
      const TileRecordPtr lit = bench->tile_for(c, cache);
      bytes.push_back(bench->tile_hash());
      const TileRecordPtr relit = bench->tile_for(c, cache, kRelitTile);
      const Picture truth = bench->truth(c, 4), mesh = bench->mesh_picture(c);
      const auto psnr = [&](const Picture& test) {
        return field_fidelity({kLitEdge, kLitEdge, truth.data()}, {kLitEdge, kLitEdge, test.data()})
            .psnr_db.value_or(0);
      };
      const double as_mesh = psnr(mesh);
      const double as_quad = psnr(bench->picture(c, lit, DrawMethod::kQuad));
      const double as_relief = psnr(bench->picture(c, lit, DrawMethod::kDepth));
      const double as_relit = psnr(bench->picture(c, relit, DrawMethod::kQuad));
      std::printf(
          "[ FIGURES  ] fog %.2f at %4.1f r against truth: mesh %.1f dB, quad %.1f dB, "
          "relief %.1f dB, relit %.1f dB\n",
          static_cast<double>(density), radii, as_mesh, as_quad, as_relief, as_relit);
      for (const double db : {as_mesh, as_quad, as_relief, as_relit}) EXPECT_GE(db, 43);
      if (radii > 4)
        keep(density > 0 ? "fog" : "fog_none",
             {truth, mesh, bench->picture(c, lit, DrawMethod::kQuad)});
    }
  }
  ASSERT_EQ(bytes.size(), 4u);
  EXPECT_EQ(bytes[0], bytes[2]);
  EXPECT_EQ(bytes[1], bytes[3]);
}

struct LitModel {
  const char* name;
  const char* spec;  // relative paths start at the shared models
  double lit_db, relit_db;
  BenchLight light = BenchLight::kLit;
};
const LitModel kModels[] = {
    {"knot", "builtin:knot", 50, 44},
    {"knot_in_a_probe", "builtin:knot", 50, 44, BenchLight::kProbe},
    {"helmet_in_a_probe", "assets/objects/flight_helmet.glb", 40, 35, BenchLight::kProbe},
    {"flight_helmet", "assets/objects/flight_helmet.glb", 41, 35},
    {"tree", "assets/reference/tree.glb", 33, 31}};

std::unique_ptr<Bench> lit_bench_for(const LitModel& model, const Similarity& at = placed()) {
  std::string spec = model.spec;
  if (spec.rfind("builtin:", 0) != 0) {
    spec = (data_folder() / spec).string();
    if (!std::ifstream(spec)) return nullptr;
  }
  return Bench::create(spec, model.light, at);
}

class LitAndRelit : public testing::TestWithParam<LitModel> {};

TEST_P(LitAndRelit, MatchTheMeshAndTheTruth) {
  const LitModel& model = GetParam();
  const std::unique_ptr<Bench> bench = lit_bench_for(model);
  ASSERT_TRUE(bench) << "no " << model.spec;
  Agreement mesh_truth, lit_truth, relit_truth, lit_mesh, relit_mesh;
  std::size_t lit_bytes = 0, relit_bytes = 0;
  for (int i = 0; i < kLitDirections; ++i) {
    const Camera c = bench->camera(4, fibonacci_direction(i, kLitDirections));
    TileCache cache = bench->make_cache();
    const TileRecordPtr lit = bench->tile_for(c, cache);
    lit_bytes += bench->tile_bytes();
    const TileRecordPtr relit = bench->tile_for(c, cache, kRelitTile);
    relit_bytes += bench->tile_bytes();
    ASSERT_TRUE(lit && relit && relit->relit);
    const Picture truth = bench->truth(c, 4), mesh = bench->mesh_picture(c);
    const Picture a = bench->picture(c, lit, DrawMethod::kQuad);
    const Picture b = bench->picture(c, relit, DrawMethod::kQuad);
    mesh_truth.add(truth, mesh);
    lit_truth.add(truth, a);
    relit_truth.add(truth, b);
    lit_mesh.add(mesh, a);
    relit_mesh.add(mesh, b);
    if (i == 3) keep(std::string("light_") + model.name, {truth, mesh, a, b});
  }
  mesh_truth.print(model.name, "mesh against truth");
  lit_truth.print(model.name, "lit against truth");
  relit_truth.print(model.name, "relit against truth");
  lit_mesh.print(model.name, "lit against mesh");
  relit_mesh.print(model.name, "relit against mesh");
  std::printf("[ FIGURES  ] %-14s bytes: lit %zu, relit %zu a tile\n", model.name,
              lit_bytes / kLitDirections, relit_bytes / kLitDirections);
  EXPECT_GE(lit_truth.psnr.mean().value_or(0), model.lit_db);
  EXPECT_GE(relit_truth.psnr.mean().value_or(0), model.relit_db);
  EXPECT_LT(relit_bytes, 3 * lit_bytes);
}

// One relit tile shows every light; a lit one shows the light it was made for.
TEST_P(LitAndRelit, OnlyTheRelitTileFollowsTheLight) {
  const LitModel& model = GetParam();
  const std::unique_ptr<Bench> bench = lit_bench_for(model);
  ASSERT_TRUE(bench) << "no " << model.spec;
  Agreement lit_after, relit_after, traced_after;
  for (int i = 0; i < kLitDirections; ++i) {
    const Camera c = bench->camera(4, fibonacci_direction(i, kLitDirections));
    TileCache cache = bench->make_cache();
    const Lighting before = bench->light();
    const TileRecordPtr lit = bench->tile_for(c, cache);
    const TileRecordPtr relit = bench->tile_for(c, cache, kRelitTile);
    bench->set_light(other_light(*bench));
    const Picture truth = bench->truth(c, 4);
    const Picture a = bench->picture(c, lit, DrawMethod::kQuad);
    const Picture b = bench->picture(c, relit, DrawMethod::kQuad);
    const Picture traced = bench->picture(c, relit, DrawMethod::kDepth);
    lit_after.add(truth, a);
    relit_after.add(truth, b);
    traced_after.add(truth, traced);
    if (i == 3) keep(std::string("light_other_") + model.name, {truth, a, b, traced});
    bench->set_light(before);
  }
  lit_after.print(model.name, "lit, after a change");
  relit_after.print(model.name, "relit, after a change");
  traced_after.print(model.name, "relit relief");
  EXPECT_LT(lit_after.psnr.mean().value_or(0), relit_after.psnr.mean().value_or(0) - 5);
  EXPECT_GE(relit_after.psnr.mean().value_or(0), model.relit_db);
  EXPECT_GE(traced_after.psnr.mean().value_or(0), model.relit_db - 1);
}

INSTANTIATE_TEST_SUITE_P(Models, LitAndRelit, testing::ValuesIn(kModels),
                         [](const auto& model) { return std::string(model.param.name); });

// Returns the fastest of some runs, ms: the machine's load only adds time.
double lit_draw_ms(Bench& bench, const Camera& camera, const TileRecordPtr& tile,
                   DrawMethod method) {
  double best = 1e9;
  for (int run = 0; run < 8; ++run) {
    const auto start = std::chrono::steady_clock::now();
    bench.draw(camera, tile, method);
    glFinish();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    best = std::min(best, took.count());
  }
  return best;
}

// Times are printed, not judged, because they depend on the machine.
TEST(LightCost, OfShadingWhereItIsDrawn) {
  const std::unique_ptr<Bench> bench = lit_bench_for(kModels[0]);
  ASSERT_TRUE(bench);
  const Camera c = bench->camera(4, fibonacci_direction(3, kLitDirections));
  TileCache cache = bench->make_cache();
  const TileRecordPtr lit = bench->tile_for(c, cache);
  const TileRecordPtr relit = bench->tile_for(c, cache, kRelitTile);
  for (const auto& [name, method] :
       {std::pair{"quad", DrawMethod::kQuad}, {"relief", DrawMethod::kDepth}}) {
    const double a = lit_draw_ms(*bench, c, lit, method), b = lit_draw_ms(*bench, c, relit, method);
    std::printf("[ FIGURES  ] cost of relit %s: %.2f x lit (%.2f ms against %.2f ms)\n", name,
                b / a, b, a);
    EXPECT_GT(a, 0);
  }
}

}  // namespace
}  // namespace mirage::test
