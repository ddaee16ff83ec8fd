#pragma once
// Weathers that sessions run through, and the tables of their results.

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "client/link/net_model.h"
#include "client/report/plot.h"
#include "client/report/table.h"

namespace mirage {

/// A weather: a link, a scene and a path through the scene.
struct Weather {
  std::string name, scene, path;
  NetModel net;  ///< the run sets its seed
};
/// Returns the ten weathers of the table. With a `scene`, returns those on the same scene, whatever
/// its options; they then run on exactly `scene`.
std::vector<Weather> weathers_on(const std::string& scene);
/// Returns the scene with a seed, which gives other trees or desks. A scene with options of its own
/// stays unchanged.
std::string seeded(const std::string& scene, std::uint64_t seed);

/// One weather with one seed. NaN: not measured.
struct WeatherRun {
  Weather weather;
  std::uint64_t seed = 1;
  double budget_ms = 0;                         ///< time budget of a frame; 0: none
  std::vector<std::pair<double, double>> flip;  ///< (seconds, FLIP) of each compared frame
  double flip_mean = NAN, flip_worst = NAN;
  double psnr_db = NAN;
  double client_ms_p95 = NAN;  ///< by the device model, after the first second
  /// share of the pixels that show an object for which nothing is drawn
  double hole_fraction = 0;
  /// share of the instances in view without an image, over all frames
  double no_image_fraction = 0;
  /// share of the frames in which first images wait although link and server are idle
  double starved_fraction = 0;
  double mb = 0;                       ///< received, 10^6 bytes
  double link_used = 0;                ///< share of the link's rate, both ways together
  std::uint64_t bound_violations = 0;  ///< pixels beyond their bound
};

/// Returns a row for each run.
Table weather_csv(const std::vector<WeatherRun>& runs);
/// Returns a row for each weather: medians over its seeds, unless a column says otherwise. The last
/// two rows are the median and the worst of every column.
Table weather_table(const std::vector<WeatherRun>& runs);
/// Returns the cost of a budget, a row for each weather: medians over its seeds with and without a
/// budget. The last two rows are the median and the worst. `runs` holds both kinds.
Table weather_budget_table(const std::vector<WeatherRun>& runs);
/// Returns plots of FLIP over time, median over seeds: a panel for each scene, a line for each
/// weather.
std::vector<Panel> weather_panels(const std::vector<WeatherRun>& runs);

}  // namespace mirage
