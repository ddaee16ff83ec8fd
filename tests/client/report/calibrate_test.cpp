// Calibrate: coefficients are recovered from samples made with them, and ranks are as they should
// be.
#include <gtest/gtest.h>

#include "client/report/calibrate_rows.h"

namespace mirage {
namespace {

ErrorSample sample(const Wrongs& wrongs, double flip, double pixels = 400) {
  ErrorSample out;
  out.wrongs = wrongs;
  out.flip = flip;
  out.pixels = out.area_px = pixels;
  return out;
}

std::vector<ErrorSample> samples(const ErrorModel& truth) {
  std::vector<ErrorSample> out;
  for (double area = 64; area < 1e5; area *= 3) {
    for (const int samples : {1, 4}) {
      for (const bool tested : {false, true}) {
        for (const double error : {0.0, 0.5, 2.0, 7.0}) {
          const Wrongs mesh = mesh_wrongs(area, tested, error, samples, samples > 1 ? 1 : 0.5);
          const Wrongs tile = tile_wrongs(area, tested, error, 1 + error * error, samples);
          for (const Wrongs& wrongs : {mesh, tile}) {
            out.push_back(sample(wrongs, truth.flip_of(wrongs), area));
          }
        }
      }
    }
    for (const Wrongs& wrongs : {view_wrongs(area), nothing_wrongs(area)}) {
      out.push_back(sample(wrongs, truth.flip_of(wrongs), area));
    }
  }
  return out;
}

TEST(ReportCalibrate, CoefficientsComeBackFromWhatTheyPredict) {
  ErrorModel truth = error_model(), first;
  for (std::size_t k = 0; k < kWrongs; ++k) {
    truth.flip[k] *= k % 2 ? 0.7 : 1.3;
    first.flip[k] = 0.01;
  }
  const std::vector<ErrorSample> all = samples(truth);
  const ErrorModel fitted = fitted_errors(all, first);
  for (const ErrorSample& one : all) {
    EXPECT_NEAR(fitted.flip_of(one.wrongs), one.flip, 0.02);
  }
  EXPECT_NEAR(mean_excess(all, fitted), 0, 0.005);
  EXPECT_LT(mean_excess(all, truth), 1e-9);
  EXPECT_GT(rank_correlation(all, fitted).flip, 0.98);
}

TEST(ReportCalibrate, RanksAreSpearmans) {
  ErrorModel model;
  model.flip[static_cast<std::size_t>(Wrong::kTileError)] = 0.1;
  const auto row = [](double error, double flip) {
    return sample(tile_wrongs(400, false, error, 1, 4), flip);
  };
  EXPECT_NEAR(rank_correlation({row(1, .1), row(2, .2), row(3, .9)}, model).flip, 1, 1e-12);
  EXPECT_NEAR(rank_correlation({row(1, .3), row(2, .2), row(3, .1)}, model).error, -1, 1e-12);
  // 1 - 6 sum d^2 / (n (n^2 - 1)) with d = 0, 1, 1, 0.
  const auto near = rank_correlation({row(1, .1), row(2, .3), row(3, .2), row(4, .4)}, model);
  EXPECT_NEAR(near.flip, 0.8, 1e-12);
  // Equal values share a rank: 1.5, 1.5, 3 beside 1, 2, 3.
  const auto tied = rank_correlation({row(1, .1), row(1, .2), row(3, .3)}, model);
  EXPECT_NEAR(tied.flip, 0.8660254, 1e-6);
  EXPECT_EQ(rank_correlation({row(1, .1), row(2, .2)}, model).flip, 0) << "too few";
  EXPECT_EQ(rank_correlation({row(1, .1), row(1, .2), row(1, .3)}, model).flip, 0) << "all equal";
}

}  // namespace
}  // namespace mirage
