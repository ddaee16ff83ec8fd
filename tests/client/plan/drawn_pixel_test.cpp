// How fine tiles are asked for while the picture is drawn smaller than it is shown.
#include "client/plan/drawn_pixel.h"

#include <gtest/gtest.h>

#include "client/plan/tile_need.h"

namespace mirage {
namespace {

TEST(DrawnPixel, AWholePictureHasPixelsOfOne) {
  DrawnPixel pixel;
  for (int frame = 0; frame < 10; ++frame) EXPECT_EQ(pixel.update(1, false, 50'000 * frame), 1);
}

TEST(DrawnPixel, ASmallerScaleCountsAtOnceAndALargerOneInASecond) {
  DrawnPixel pixel;
  EXPECT_EQ(pixel.update(1, false, 0), 1);
  EXPECT_EQ(pixel.update(0.25, false, 50'000), 4);
  EXPECT_GT(pixel.update(1, false, 100'000), 3) << "one frame says little";
  EXPECT_LT(pixel.update(1, false, 4'000'000), 1.2);
}

TEST(DrawnPixel, AStillEyeSeesWholePixels) {
  DrawnPixel pixel;
  EXPECT_EQ(pixel.update(0.25, false, 0), 4);
  EXPECT_EQ(pixel.update(0.25, true, 50'000), 1);
  EXPECT_EQ(pixel.update(0.25, false, 100'000), 4);
}

TEST(DrawnPixel, ATileIsAskedForByTheDrawnPixel) {
  ViewGeometry view;
  view.focal_px = 600;
  view.radius = 1;
  view.eye = {0, 0, 10};
  view.center_depth = 10;
  ViewPlan whole, half;
  half.pixel_px = 2;
  const int classes_of_half = 2;  // of sqrt 2 each
  EXPECT_EQ(need_for_view(view, half).size_class + classes_of_half,
            need_for_view(view, whole).size_class);
  EXPECT_EQ(need_for_view(view, half).cell, need_for_view(view, whole).cell);
}

}  // namespace
}  // namespace mirage
