// Refinement: a picture at rest becomes the mean of many drawings: nearer the full render, but in
// its place.

#include <gtest/gtest.h>

#include "tests/gl/bench.h"

namespace mirage::test {
namespace {

double psnr_beside(const std::vector<std::uint8_t>& truth, const std::vector<std::uint8_t>& seen) {
  const std::uint32_t n = Bench::kSize;
  return measure_images({n, n, truth.data()}, {n, n, seen.data()}).psnr_db.value_or(0);
}

class RefinementTest : public ::testing::Test {
 protected:
  void SetUp() override {
    bench_ = Bench::create("builtin:knot", BenchLight::kLit);
    ASSERT_TRUE(bench_);
    camera_ = bench_->camera(4, glm::normalize(glm::dvec3(1, 0.4, 0.7)));
    truth_ = bench_->truth(camera_, 8);
  }
  std::unique_ptr<Bench> bench_;
  Camera camera_;
  std::vector<std::uint8_t> truth_;
};

TEST_F(RefinementTest, ComesNearerTheFullRender) {
  const double once = psnr_beside(truth_, bench_->mesh_picture(camera_));
  const double few = psnr_beside(truth_, bench_->rested_mesh_picture(camera_, 4));
  const double all =
      psnr_beside(truth_, bench_->rested_mesh_picture(camera_, Refinement::kDrawings));
  RecordProperty("psnr_once", std::to_string(once));
  RecordProperty("psnr_rested", std::to_string(all));
  EXPECT_GT(few, once + 0.5);
  EXPECT_GT(all, once + 2);
}

// Drawings moved by parts of a pixel to all sides have their mean where the picture was.
TEST_F(RefinementTest, MovesNothing) {
  const double here =
      psnr_beside(truth_, bench_->rested_mesh_picture(camera_, Refinement::kDrawings));
  for (const glm::dvec2& shift :
       {glm::dvec2(0.1, 0), glm::dvec2(-0.1, 0), glm::dvec2(0, 0.1), glm::dvec2(0, -0.1)}) {
    Camera aside = camera_;
    aside.shift_px = shift;
    EXPECT_LT(psnr_beside(truth_, bench_->rested_mesh_picture(aside, Refinement::kDrawings)), here);
  }
}

// A picture that was drawn small to save time rests at its full size.
TEST_F(RefinementTest, AnEnlargedPictureRestsAtFullScale) {
  const double small = psnr_beside(truth_, bench_->rested_mesh_picture(camera_, 0, 0.5));
  const double rested =
      psnr_beside(truth_, bench_->rested_mesh_picture(camera_, Refinement::kDrawings, 0.5));
  const double usual =
      psnr_beside(truth_, bench_->rested_mesh_picture(camera_, Refinement::kDrawings));
  EXPECT_GT(rested, small + 4);
  EXPECT_NEAR(rested, usual, 0.5);
}

TEST_F(RefinementTest, EndsByItself) {
  const auto all = bench_->rested_mesh_picture(camera_, Refinement::kDrawings);
  EXPECT_EQ(bench_->rested_mesh_picture(camera_, 4 * Refinement::kDrawings), all);
}

}  // namespace
}  // namespace mirage::test
