#pragma once
// The weathers a session is run through, and the tables of what it came to.

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "client/link/net_model.h"
#include "client/report/plot.h"
#include "client/report/table.h"

namespace mirage {

/// A link, a scene and a way through it.
struct Weather {
  std::string name, scene, path;
  NetModel net;  ///< its seed is the run's
};
/// The ten of the table, or those of them that are on `scene`, whatever its options: they are then
/// on just that one.
std::vector<Weather> weathers_on(const std::string& scene);
/// The scene for a seed: other trees, other desks; one with options of its own stays as it is.
std::string seeded(const std::string& scene, std::uint64_t seed);

/// One weather with one seed. Not a number: not measured.
struct WeatherRun {
  Weather weather;
  std::uint64_t seed = 1;
  double budget_ms = 0;                         ///< of a frame; 0: none
  std::vector<std::pair<double, double>> flip;  ///< seconds, FLIP: a compared frame each
  double flip_mean = NAN, flip_worst = NAN;
  double psnr_db = NAN;
  double client_ms_p95 = NAN;    ///< by the device model, from the second second on
  double hole_fraction = 0;      ///< of the pixels that show an object: nothing drawn for it
  double no_image_fraction = 0;  ///< of the instances in view, over all frames
  double starved_fraction = 0;   ///< of the frames: neither link nor server busy, and yet first
                                 ///< images wait to be asked for
  double mb = 0;                 ///< down, 10^6 bytes
  double link_used = 0;          ///< of the rate, both ways together
  std::uint64_t bound_violations = 0;  ///< pixels
};

/// A row for each run.
Table weather_csv(const std::vector<WeatherRun>& runs);
/// A row for each weather, medians over its seeds where nothing else is said; at the end the median
/// and the worst of every column.
Table weather_table(const std::vector<WeatherRun>& runs);
/// What a budget costs: FLIP within it and without, a row for each weather, medians over its seeds;
/// at the end the median and the worst. `runs`: of both.
Table weather_budget_table(const std::vector<WeatherRun>& runs);
/// FLIP over time, median over seeds; a panel for each scene, a line for each weather.
std::vector<Panel> weather_panels(const std::vector<WeatherRun>& runs);

}  // namespace mirage
