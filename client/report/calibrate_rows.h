#pragma once
// Samples that calibration observes, and the coefficients and figures computed from them.

#include <string>
#include <vector>

#include "client/plan/alternatives.h"
#include "client/report/session_run.h"
#include "client/report/table.h"
#include "protocol/quality/flip.h"

namespace mirage {

/// An object or group in a compared frame.
struct ErrorSample {
  std::string scene;
  Look look = Look::kNothing;
  Wrongs wrongs{};     ///< errors of the way it was drawn
  double area_px = 0;  ///< area that the plan expected it to cover
  double pixels = 0;   ///< pixels of the full render that show it
  double flip = 0;     ///< mean FLIP of these pixels
};

/// Returns the samples of a frame. It leaves out what was drawn in more than one way, and what
/// covers too few pixels to measure.
std::vector<ErrorSample> samples_of(const ObservedFrame& frame, const std::string& scene);
/// Fits the coefficients to the samples by least squares, weighted by the root of a sample's
/// pixels. No coefficient is below 0.
ErrorModel fitted_errors(const std::vector<ErrorSample>& samples, const ErrorModel& first);
/// Spearman's rank correlation of predicted and measured error, -1 to 1. Equal values share their
/// mean rank. It is 0 with fewer than three samples, or if all values are equal.
struct RankCorrelation {
  double error = 0;  ///< of FLIP times pixels, which the plan minimises
  double flip = 0;   ///< of FLIP per pixel
};
RankCorrelation rank_correlation(const std::vector<ErrorSample>& samples, const ErrorModel& model);
/// Returns the mean of measured minus predicted FLIP, weighted by pixels.
double mean_excess(const std::vector<ErrorSample>& samples, const ErrorModel& model);
Table calibration_csv(const std::vector<ErrorSample>& samples, const ErrorModel& model);

}  // namespace mirage
