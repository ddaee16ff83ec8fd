#include "client/report/plot.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "client/report/table.h"
#include "protocol/process/child.h"

namespace mirage {
namespace {

constexpr int kPanelWidth = 470, kPanelHeight = 330, kLegendHeight = 90;

struct LineLook {
  const char* color;
  int point, variant;  // for the name alone, and for a variant (after a comma)
};

// Returns a colour of Okabe and Ito, which colour-blind people can tell apart, too; points differ
// as well.
LineLook look_of(const std::string& name, std::size_t index) {
  static const std::map<std::string, LineLook> known = {
      {"auto", {"#000000", 7, 6}},     {"mirage", {"#000000", 7, 6}},
      {"quad", {"#e69f00", 5, 4}},     {"cuboid", {"#56b4e9", 9, 8}},
      {"hull", {"#009e73", 11, 10}},   {"warp", {"#cc79a7", 13, 12}},
      {"depth", {"#0072b2", 15, 14}},  {"mesh", {"#999999", 7, 6}},
      {"geometry", {"#999999", 7, 6}}, {"fixed8", {"#d55e00", 2, 1}},
      {"video", {"#e69f00", 5, 4}},    {"video+timewarp", {"#0072b2", 15, 14}},
      {"budget", {"#cc0000", 1, 1}}};
  static const LineLook other[] = {{"#009e73", 9, 8},   {"#cc79a7", 11, 10}, {"#56b4e9", 13, 12},
                                   {"#d55e00", 2, 1},   {"#e69f00", 5, 4},   {"#999999", 6, 7},
                                   {"#0072b2", 15, 14}, {"#000000", 7, 6},   {"#cc79a7", 1, 2},
                                   {"#009e73", 3, 1}};
  const std::size_t comma = name.find(',');
  const auto at = known.find(name.substr(0, comma));
  LineLook look = at != known.end() ? at->second : other[index % std::size(other)];
  if (comma != std::string::npos) look.point = look.variant;
  return look;
}

// Quotes text: escapes quotes and gnuplot's own markup characters.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

bool drawable(const Panel& panel, const std::pair<double, double>& p) {
  return std::isfinite(p.first) && std::isfinite(p.second) && (!panel.log_x || p.first > 0) &&
         (!panel.log_y || p.second > 0);
}

// Labels an axis with 1, 2, 5 times powers of ten over the data: gnuplot alone labels whole decades
// only.
std::string log_axis(char axis, std::vector<double> values) {
  if (values.empty()) return {};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double low = *least / 1.2, high = *most * 1.2;
  const double decades = std::log10(high / low);
  const std::vector<double> steps = decades > 3     ? std::vector<double>{1}
                                    : decades > 0.9 ? std::vector<double>{1, 2, 5}
                                                    : std::vector<double>{1, 1.5, 2, 3, 4, 5, 6, 8};
  std::string tics;
  for (int decade = static_cast<int>(std::floor(std::log10(low))); std::pow(10, decade) <= high;
       ++decade) {
    for (const double step : steps) {
      const double v = step * std::pow(10, decade);
      if (v < low || v > high) continue;
      tics += fmt::format("{}\"{:g}\" {:g}", tics.empty() ? "" : ", ", v, v);
    }
  }
  return fmt::format("set logscale {0}\nset {0}range [{1:g}:{2:g}]\nset {0}tics ({3})\n", axis, low,
                     high, tics);
}

void add_block(std::string& script, const std::string& name, const Panel& panel,
               const std::vector<std::pair<double, double>>& points) {
  script += "$" + name + " << EOD\n";
  std::size_t kept = 0;
  for (const auto& p : points) {
    if (!drawable(panel, p)) continue;
    script += fmt::format("{:.9g} {:.9g}\n", p.first, p.second);
    ++kept;
  }
  if (kept == 0) script += "NaN NaN\n";
  script += "EOD\n";
}

// Returns the names in order of appearance, so that a name looks the same in all panels and the
// legend.
std::vector<std::string> names_of(const std::vector<Panel>& panels) {
  std::vector<std::string> names;
  for (const Panel& panel : panels) {
    for (const Series& series : panel.series) {
      if (std::find(names.begin(), names.end(), series.name) == names.end()) {
        names.push_back(series.name);
      }
    }
  }
  return names;
}

void add_panel(std::string& script, Panel panel, std::size_t index,
               const std::vector<std::string>& names) {
  // A logarithmic axis has nothing to show if no value is above 0.
  panel.log_y =
      panel.log_y && std::any_of(panel.series.begin(), panel.series.end(), [](const Series& s) {
        return std::any_of(s.points.begin(), s.points.end(),
                           [](const auto& p) { return p.second > 0; });
      });

  std::vector<double> xs, ys;
  for (const Series& series : panel.series) {
    for (const auto& p : series.points) {
      if (!drawable(panel, p)) continue;
      xs.push_back(p.first);
      ys.push_back(p.second);
    }
  }
  if (panel.floor && *panel.floor > 0) ys.push_back(*panel.floor);
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    add_block(script, fmt::format("d{}_{}", index, i), panel, panel.series[i].points);
  }
  add_block(script, fmt::format("front{}", index), panel, panel.front);
  script += "unset logscale\nset autoscale\nset xtics autofreq\nset ytics autofreq\nunset key\n";
  if (panel.log_x) script += log_axis('x', xs);
  if (panel.log_y) script += log_axis('y', ys);
  const bool all_zero = std::all_of(ys.begin(), ys.end(), [](double y) { return y == 0; });
  if (!panel.log_y) script += all_zero ? "set yrange [0:1]\n" : "set yrange [0:*]\n";
  if (xs.empty()) script += "set xrange [1:10]\nset yrange [1:10]\n";
  script += "set title " + quoted(panel.title) + "\nset xlabel " + quoted(panel.x_label) +
            "\nset ylabel " + quoted(panel.y_label) + "\n";
  std::string plots;
  if (!panel.front.empty()) {
    plots += fmt::format(", $front{} using 1:2 with lines lw 5 lc rgb \"#ffd24d\" notitle", index);
  }
  if (panel.floor) {
    plots +=
        fmt::format(", {:.9g} with lines dt 2 lw 1.5 lc rgb \"#cc0000\" notitle", *panel.floor);
  }
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const std::string& name = panel.series[i].name;
    const auto at = std::find(names.begin(), names.end(), name) - names.begin();
    const LineLook look = look_of(name, static_cast<std::size_t>(at));
    plots += fmt::format(
        ", $d{}_{} using 1:2 with linespoints lw 1.4 pt {} ps 0.8 lc rgb \"{}\" notitle", index, i,
        look.point, look.color);
  }
  script += "plot " + plots.substr(2) + "\n";
}

// Draws one legend for all panels, as an empty plot that has only its key.
std::string legend(const std::vector<Panel>& panels, const std::vector<std::string>& names) {
  bool floor = false, front = false;
  for (const Panel& panel : panels) {
    floor = floor || panel.floor.has_value();
    front = front || !panel.front.empty();
  }
  std::string plots;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const LineLook look = look_of(names[i], i);
    // A variant has the colour of its name, and no entry beside it.
    const std::size_t comma = names[i].find(',');
    const bool variant =
        comma != std::string::npos &&
        std::find(names.begin(), names.end(), names[i].substr(0, comma)) != names.end();
    if (variant) continue;
    plots += fmt::format(", NaN with linespoints lw 1.4 pt {} ps 0.8 lc rgb \"{}\" title {}",
                         look.point, look.color, quoted(names[i]));
  }
  if (front) plots += ", NaN with lines lw 5 lc rgb \"#ffd24d\" title \"Pareto front\"";
  if (floor) {
    plots += ", NaN with lines dt 2 lw 1.5 lc rgb \"#cc0000\" title \"error floor, 2x against 4x\"";
  }
  return "unset logscale\nunset title\nunset xlabel\nunset ylabel\nunset border\nunset tics\n"
         "unset grid\nset margins 0,0,0,0\nset key center center horizontal maxrows 3 samplen "
         "2\nset xrange [0:1]\n"
         "set yrange [0:1]\nplot " +
         plots.substr(2) + "\n";
}

}  // namespace

std::string plot_script(const std::vector<Panel>& panels, int columns,
                        const std::string& svg_file) {
  const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
  const int width = columns * kPanelWidth, height = rows * kPanelHeight + kLegendHeight;
  const std::vector<std::string> names = names_of(panels);
  std::string script = fmt::format(
      "set terminal svg noenhanced size {},{} font \"sans-serif,13\" background \"#ffffff\"\n"
      "set output {}\nset multiplot\nset grid lc rgb \"#dddddd\"\nset border lc rgb \"#444444\"\n",
      width, height, quoted(svg_file));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const int row = static_cast<int>(i) / columns, column = static_cast<int>(i) % columns;
    script += fmt::format("set size {:.5f},{:.5f}\nset origin {:.5f},{:.5f}\n", 1.0 / columns,
                          static_cast<double>(kPanelHeight) / height,
                          static_cast<double>(column) / columns,
                          1.0 - static_cast<double>((row + 1) * kPanelHeight) / height);
    add_panel(script, panels[i], i, names);
  }
  script += fmt::format("set size 1,{:.5f}\nset origin 0,0\n",
                        static_cast<double>(kLegendHeight) / height);
  return script + legend(panels, names) + "unset multiplot\n";
}

std::string inline_svg(std::string svg, const std::string& prefix) {
  const std::size_t start = svg.find("<svg");
  svg.erase(0, start == std::string::npos ? svg.size() : start);
  // Ids are made unique, because several pictures share a page and gnuplot gives each the same ids.
  for (const std::string& id : {std::string("gp"), std::string("gnuplot_")}) {
    for (const std::string& before :
         {std::string("id=\""), std::string("id='"), std::string("href=\"#"),
          std::string("href='#"), std::string("url(#")}) {
      std::size_t at = 0;
      while ((at = svg.find(before + id, at)) != std::string::npos) {
        svg.insert(at + before.size(), prefix + "_");
        at += before.size() + prefix.size();
      }
    }
  }
  return svg;
}

Plotter::Plotter(std::string folder)
    : folder_(std::move(folder)), gnuplot_(find_program("gnuplot")) {}

Result<std::string> Plotter::draw(const std::string& name, const std::vector<Panel>& panels,
                                  int columns) {
  if (!gnuplot_) {
    return make_error(ErrorId::kIo, "gnuplot is not installed", "apt-get install gnuplot-nox");
  }
  const std::string svg = folder_ + "/" + name + ".svg", script = folder_ + "/" + name + ".gp";
  if (Result<void> r = write_file(script, plot_script(panels, columns, svg)); !r) return r.error();
  const Result<ChildResult> ran = run_child({*gnuplot_, script});
  if (!ran) return ran.error();
  std::ifstream file(svg, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (ran->exit_code != 0 || text.str().find("</svg>") == std::string::npos) {
    return make_error(ErrorId::kIo, "gnuplot drew no " + name + ": " + ran->err);
  }
  return inline_svg(text.str(), name);
}

}  // namespace mirage
