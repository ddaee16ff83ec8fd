// Impostors against the full render of the same build: the fidelity protocol of the field
// (512 x 512, 24 Fibonacci directions, fewer for the tree, tight field of view, grey
// background). Every row prints its figures.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <tuple>

#include "client/draw/geometric_error.h"
#include "client/frame/planned_frame.h"
#include "client/plan/tile_need.h"
#include "protocol/impostor/error_bound.h"
#include "server/render/gpu_scene.h"
#include "tests/gl/bench.h"
#include "tests/support/data_folder.h"

namespace mirage::test {
namespace {

constexpr int kDirections = 24;
constexpr int kTreeDirections = 4;  // its truth takes seconds a picture on a CPU
constexpr std::uint32_t kFieldEdge = Bench::kSize;
constexpr double kGridMiB = 42.7;  // of the 12 x 12 grid of views to compare with

struct Model {
  const char* name;
  const char* spec;  // relative paths start at the shared models
  BenchLight light;
};
constexpr Model kKnot{"knot", "builtin:knot", BenchLight::kLit};
constexpr Model kTree{"tree", "assets/reference/tree.glb", BenchLight::kAlbedo};
constexpr Model kMonkey{"monkey", "assets/reference/monkey.glb", BenchLight::kLit};

struct Row {
  const char* name;
  Model model;
  double radii;
  double degrees;  // angle between the tile's capture and the eye
  DrawMethod method;
  double least_psnr;
  double least_iou;
  int directions = 24;
};

std::ostream& operator<<(std::ostream& out, const Row& row) { return out << row.name; }

// A bench, and the full renders made with it, by distance in radii, direction and number of
// directions: they take most of the time, and many rows compare with the same.
struct Shared {
  std::unique_ptr<Bench> bench;
  std::map<std::tuple<double, int, int>, std::vector<std::uint8_t>> truths;
};

// The bench in use, by model. It stays as long as the following tests want the same.
std::map<std::string, Shared>& shared_benches() {
  static std::map<std::string, Shared> benches;
  return benches;
}

class ReleaseBenches : public ::testing::Environment {
  void TearDown() override { shared_benches().clear(); }
};
[[maybe_unused]] const auto* const release_benches =
    ::testing::AddGlobalTestEnvironment(new ReleaseBenches);  // owned by gtest

// Returns the bench of the model; nullptr: the model is missing.
Bench* bench_for(const Model& model) {
  std::map<std::string, Shared>& benches = shared_benches();
  std::string spec = model.spec;
  if (spec.rfind("builtin:", 0) != 0) {
    spec = (data_folder() / spec).string();
    if (!std::ifstream(spec)) return nullptr;
  }
  // One context at a time: each bench has one, and the newest is current.
  if (!benches[model.name].bench) {
    benches.clear();
    benches[model.name].bench = Bench::create(spec, model.light);
  }
  Bench* made = benches[model.name].bench.get();
  if (made) made->make_current();
  return made;
}

const std::vector<std::uint8_t>& truth_of(const Row& row, int direction, const Camera& camera) {
  Shared& shared = shared_benches()[row.model.name];
  std::vector<std::uint8_t>& truth = shared.truths[{row.radii, direction, row.directions}];
  if (truth.empty()) truth = shared.bench->truth(camera, 4);
  return truth;
}

// Keeps the drawn picture, the truth and twice the difference side by side, if a folder is given.
void keep_picture(const std::string& name, const std::vector<std::uint8_t>& drawn,
                  const std::vector<std::uint8_t>& truth) {
  const char* folder = std::getenv("MIRAGE_FIDELITY_PICTURES");
  if (!folder) return;
  std::ofstream file(std::string(folder) + "/" + name + ".ppm", std::ios::binary);
  file << "P6 " << 3 * kFieldEdge << " " << kFieldEdge << " 255\n";
  for (std::size_t y = 0; y < kFieldEdge; ++y) {
    for (int panel = 0; panel < 3; ++panel) {
      for (std::size_t i = y * kFieldEdge * 4; i < (y + 1) * kFieldEdge * 4; ++i) {
        if (i % 4 == 3) continue;
        const int d = std::min(255, 2 * std::abs(drawn[i] - truth[i]));
        file.put(static_cast<char>(panel == 0 ? drawn[i] : panel == 1 ? truth[i] : d));
      }
    }
  }
}

class Fidelity : public testing::TestWithParam<Row> {};

TEST_P(Fidelity, Row) {
  const Row& row = GetParam();
  Bench* bench = bench_for(row.model);
  ASSERT_TRUE(bench) << "no " << row.model.spec;
  MeasureMean psnr, ssim, iou;
  std::size_t texels = 0;
  for (int i = 0; i < row.directions; ++i) {
    TileCache cache = bench->make_cache();
    const glm::dvec3 eye = fibonacci_direction(i, row.directions);
    const glm::dvec3 from = turned(eye, row.degrees, 2.4 * i);
    const TileRecordPtr tile = bench->tile_for(bench->camera(row.radii, from), cache);
    ASSERT_TRUE(tile) << "direction " << i;
    texels = std::max(texels, cache.atlas_texels());
    const Camera camera = bench->camera(row.radii, eye);
    const std::vector<std::uint8_t> drawn = bench->picture(camera, tile, row.method);
    const std::vector<std::uint8_t>& truth = truth_of(row, i, camera);
    const FieldFidelity f = field_fidelity({kFieldEdge, kFieldEdge, truth.data()},
                                           {kFieldEdge, kFieldEdge, drawn.data()});
    psnr.add(f.psnr_db);
    ssim.add(f.ssim);
    iou.add(f.iou);
    if (i == row.directions / 4) keep_picture(row.name, drawn, truth);
  }
  const double mib = static_cast<double>(texels) * 5 / (1 << 20);  // RGBA and depth
  std::printf(
      "[ FIGURES  ] %-22s %4.1f r %4.1f deg: PSNR %.1f dB, SSIM %.3f, IoU %.4f, "
      "%.2f MiB of textures\n",
      row.name, row.radii, row.degrees, psnr.mean().value_or(0), ssim.mean().value_or(0),
      iou.mean().value_or(0), mib);
  EXPECT_GE(psnr.mean().value_or(0), row.least_psnr);
  EXPECT_GE(iou.mean().value_or(0), row.least_iou);
  EXPECT_LT(mib, kGridMiB / 3);
}

constexpr DrawMethod kQuad = DrawMethod::kQuad, kRelief = DrawMethod::kDepth,
                     kHull = DrawMethod::kHull, kWarp = DrawMethod::kWarp;

const Row kRows[] = {
    {"knot_settled_2.5r", kKnot, 2.5, 0, kQuad, 44, 0.995},
    {"knot_settled_4r", kKnot, 4, 0, kQuad, 45, 0.995},
    {"knot_settled_12r", kKnot, 12, 0, kQuad, 45, 0.995},
    {"knot_settled_40r", kKnot, 40, 0, kQuad, 45, 0.995},
    {"knot_settled_relief", kKnot, 4, 0, kRelief, 45, 0.995},
    {"knot_5deg_quad", kKnot, 4, 5, kQuad, 25, 0.92},
    {"knot_5deg_hull", kKnot, 4, 5, kHull, 24.5, 0.91},
    {"knot_5deg_warp", kKnot, 4, 5, kWarp, 26.5, 0.935},
    {"knot_10deg_quad", kKnot, 4, 10, kQuad, 22, 0.855},
    {"knot_10deg_hull", kKnot, 4, 10, kHull, 21.5, 0.84},
    {"knot_10deg_warp", kKnot, 4, 10, kWarp, 23.5, 0.885},
    {"knot_5deg", kKnot, 4, 5, kRelief, 33, 0.97},
    {"knot_10deg", kKnot, 4, 10, kRelief, 29.5, 0.95},
    {"monkey_settled_4r", kMonkey, 4, 0, kQuad, 44, 0.995},
    {"tree_settled_4r", kTree, 4, 0, kQuad, 36, 0.97, kTreeDirections},
    {"tree_5deg", kTree, 4, 5, kRelief, 24, 0.84, kTreeDirections},
    {"tree_10deg", kTree, 4, 10, kRelief, 22.5, 0.80, kTreeDirections},
};

INSTANTIATE_TEST_SUITE_P(Field, Fidelity, testing::ValuesIn(kRows), [](const auto& row) {
  std::string name = row.param.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

struct Timed {
  const char* name;
  DrawMethod method;
  double degrees;
};

// Returns the fastest of some runs, ms: the machine's load only adds time.
double draw_ms(Bench& bench, const Camera& camera, const TileRecordPtr& tile, DrawMethod method) {
  double best = 1e9;
  for (int run = 0; run < 3; ++run) {
    const auto start = std::chrono::steady_clock::now();
    bench.draw(camera, tile, method);
    glFinish();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    best = std::min(best, took.count());
  }
  return best;
}

// Times are printed, not judged, because they depend on the machine; ratios of one run do less so.
TEST(Cost, OfEachMethodAgainstTheQuad) {
  Bench* bench = bench_for(kKnot);
  ASSERT_TRUE(bench);
  const glm::dvec3 eye = fibonacci_direction(5, kDirections);
  const Camera camera = bench->camera(4, eye);
  TileCache cache = bench->make_cache();
  const double quad = draw_ms(*bench, camera, bench->tile_for(camera, cache), kQuad);
  for (const Timed& t : {Timed{"cuboid", DrawMethod::kCuboid, 2},
                         {"hull", DrawMethod::kHull, 2},
                         {"warp", DrawMethod::kWarp, 2},
                         {"relief", kRelief, 0},
                         {"relief", kRelief, 1},
                         {"relief", kRelief, 5},
                         {"relief", kRelief, 10}}) {
    const TileRecordPtr tile = bench->tile_for(bench->camera(4, turned(eye, t.degrees, 0)), cache);
    const double ms = draw_ms(*bench, camera, tile, t.method);
    std::printf("[ FIGURES  ] cost of %-14s at %4.1f deg: %.2f x quad (%.2f ms)\n", t.name,
                t.degrees, ms / quad, ms);
    EXPECT_GT(ms, 0);
  }
}

// Every method shows the same picture from the capture pose; proxies only matter elsewhere.
TEST(Methods, AgreeAtTheCapturePose) {
  Bench* bench = bench_for(kKnot);
  ASSERT_TRUE(bench);
  TileCache cache = bench->make_cache();
  const Camera c = bench->camera(4, fibonacci_direction(5, kDirections));
  const TileRecordPtr tile = bench->tile_for(c, cache);
  ASSERT_TRUE(tile);
  const std::vector<std::uint8_t> quad = bench->picture(c, tile, DrawMethod::kQuad);
  for (const DrawMethod method :
       {DrawMethod::kCuboid, DrawMethod::kHull, DrawMethod::kWarp, DrawMethod::kDepth}) {
    const std::vector<std::uint8_t> other = bench->picture(c, tile, method);
    const FieldFidelity f = field_fidelity({kFieldEdge, kFieldEdge, quad.data()},
                                           {kFieldEdge, kFieldEdge, other.data()});
    EXPECT_GE(f.psnr_db.value_or(0), 50.0) << "method " << static_cast<int>(method);
  }
}

// The bound holds for every compared pixel and comes near the largest error, for every method.
TEST(Bound, HoldsAndIsTightOnDrawnTiles) {
  Bench* bench = bench_for(kKnot);
  ASSERT_TRUE(bench);
  for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kCuboid, DrawMethod::kHull,
                                  DrawMethod::kWarp, DrawMethod::kDepth}) {
    GeometricError errors;
    for (int i = 0; i < 4; ++i) {
      TileCache cache = bench->make_cache();
      const glm::dvec3 d = fibonacci_direction(i, 4);
      const TileRecordPtr tile = bench->tile_for(bench->camera(12, d), cache);
      const Camera c = bench->camera(12 + 0.2 * i, turned(d, 1 + i, 2.4 * i));
      DrawnImpostor drawn{0, tile, method, 0, glm::length(c.pose.eye), 1};
      const ObjectDescription& object = bench->scene().objects[0];
      drawn.bound_px = tile->bound_px(method, object, view_geometry(c, bench->instance(), object));
      DrawList list;
      list.impostors.push_back(drawn);
      add_geometric_error(bench->truth_frame(c, 1), 0.5, {c, &bench->scene(), list, {}}, errors);
    }
    std::vector<float> ratios = errors.ratios;
    ASSERT_FALSE(ratios.empty());
    std::nth_element(ratios.begin(), ratios.begin() + std::ptrdiff_t(ratios.size() / 2),
                     ratios.end());
    const float median = ratios[ratios.size() / 2];
    std::printf(
        "[ FIGURES  ] method %d: %llu pixels compared, %llu over the bound, median "
        "bound / largest error %.2f\n",
        static_cast<int>(method), static_cast<unsigned long long>(errors.compared),
        static_cast<unsigned long long>(errors.violations), double{median});
    EXPECT_EQ(errors.violations, 0u);
    EXPECT_GT(errors.compared, 10'000u);
    EXPECT_LE(median, 1.5);
  }
}

}  // namespace
}  // namespace mirage::test
