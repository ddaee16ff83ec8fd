#pragma once
// Plot: turns data into a gnuplot script, and the script into SVG.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

struct Series {
  /// Methods of drawing keep their colour in all plots. A variant, with more after a comma, keeps
  /// it as well, with other points.
  std::string name;
  /// Drawn as given; values that are not finite are left out.
  std::vector<std::pair<double, double>> points;
};

struct Panel {
  std::string title, x_label, y_label;  ///< labels have their units
  bool log_x = false, log_y = false;    ///< points not above 0 are then left out
  std::vector<Series> series;
  std::optional<double> floor;                   ///< a horizontal line: the error floor
  std::vector<std::pair<double, double>> front;  ///< marked and joined: the Pareto front
};

class Plotter {
 public:
  /// Writes scripts and pictures into `folder`, which must exist.
  explicit Plotter(std::string folder);

  bool available() const { return gnuplot_.has_value(); }
  /// Returns the panels in rows of `columns`, with one legend below, as an SVG element for a page.
  /// `name` makes its ids unique. Errors: kIo with the message of gnuplot.
  Result<std::string> draw(const std::string& name, const std::vector<Panel>& panels, int columns);

 private:
  std::string folder_;
  std::optional<std::string> gnuplot_;
};

/// Returns the script for `draw`; it writes to `svg_file`.
std::string plot_script(const std::vector<Panel>& panels, int columns, const std::string& svg_file);
/// Returns the svg element of a gnuplot file, without prolog, with prefixed ids.
std::string inline_svg(std::string svg, const std::string& prefix);

}  // namespace mirage
