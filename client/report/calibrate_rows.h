#pragma once
// What calibration observed, and what is reckoned from it.

#include <string>
#include <vector>

#include "client/plan/alternatives.h"
#include "client/quality/flip.h"
#include "client/report/session_run.h"
#include "client/report/table.h"

namespace mirage {

/// A thing in a compared frame.
struct ErrorSample {
  std::string scene;
  Look look = Look::kNothing;
  Wrongs wrongs{};     ///< as it was drawn
  double area_px = 0;  ///< that it was expected to cover
  double pixels = 0;   ///< of the full render that show it
  double flip = 0;     ///< mean over them
};

/// The things of a frame that were drawn in one way only and cover enough pixels to say anything.
std::vector<ErrorSample> samples_of(const ObservedFrame& frame, const std::string& scene);
/// The coefficients nearest to the samples by least squares, weighted by the root of
/// their pixels; none below 0.
ErrorModel fitted_errors(const std::vector<ErrorSample>& samples, const ErrorModel& first);
/// Spearman's rank correlation of predicted and measured error, -1 to 1; equal values share their
/// mean rank. 0 with fewer than three samples, or where all are equal.
struct RankCorrelation {
  double error = 0;  ///< FLIP times pixels: what is planned by
  double flip = 0;   ///< FLIP a pixel
};
RankCorrelation rank_correlation(const std::vector<ErrorSample>& samples, const ErrorModel& model);
/// Mean measured less mean predicted FLIP, weighted by pixels.
double mean_excess(const std::vector<ErrorSample>& samples, const ErrorModel& model);
Table calibration_csv(const std::vector<ErrorSample>& samples, const ErrorModel& model);

}  // namespace mirage
