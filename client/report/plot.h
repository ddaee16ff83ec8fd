#pragma once
// Plots: data into a gnuplot script, the script into SVG.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

struct Series {
  /// Methods of drawing keep their colour in all plots; with more after a comma, too, and other
  /// points.
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< drawn as given; not finite ones are left out
};

struct Panel {
  std::string title, x_label, y_label;  ///< labels with their units
  bool log_x = false, log_y = false;    ///< points not above 0 are then left out
  std::vector<Series> series;
  std::optional<double> floor;                   ///< a horizontal line: the error floor
  std::vector<std::pair<double, double>> front;  ///< marked and joined: the Pareto front
};

class Plotter {
 public:
  /// Scripts and pictures go into `folder`, which exists.
  explicit Plotter(std::string folder);

  bool available() const { return gnuplot_.has_value(); }
  /// The panels in rows of `columns`, under them one legend; an SVG element to be put into a page,
  /// its ids made unique by `name`. Errors: kIo with what gnuplot said.
  Result<std::string> draw(const std::string& name, const std::vector<Panel>& panels, int columns);

 private:
  std::string folder_;
  std::optional<std::string> gnuplot_;
};

/// The script for `draw`, writing to `svg_file`.
std::string plot_script(const std::vector<Panel>& panels, int columns, const std::string& svg_file);
/// The svg element of a file of gnuplot's, without prolog, ids prefixed.
std::string inline_svg(std::string svg, const std::string& prefix);

}  // namespace mirage
