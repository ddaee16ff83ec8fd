#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "client/report/latency_rows.h"

namespace mirage {
namespace {

constexpr double kLongTripMs = 100;
constexpr double kAim = 0.7;  // p95 FLIP of Mirage over that of video with timewarp

// True for runs on the scene's own path without loss and with the first seed: the grid of the
// plots.
bool in_grid(const LatencyRun& run, const std::string& scene) {
  const NetModel& net = run.condition.net;
  return run.scene == scene && run.own_path && net.loss_percent == 0 && net.seed == 1;
}

struct Grid {
  std::set<double> trips, rates;
  std::map<std::tuple<std::string, double, double>, LatencyFigures> at;  // by method, RTT and rate

  const LatencyFigures* find(const std::string& method, double rtt, double rate) const {
    const auto found = at.find({method, rtt, rate});
    return found == at.end() ? nullptr : &found->second;
  }
};

Grid grid_of(const std::vector<LatencyRun>& runs, const std::string& scene) {
  Grid grid;
  for (const LatencyRun& run : runs) {
    if (!in_grid(run, scene)) continue;
    const NetModel& net = run.condition.net;
    grid.trips.insert(net.rtt_ms);
    grid.rates.insert(net.rate_mbps);
    grid.at[{run.method, net.rtt_ms, net.rate_mbps}] = figures_of(run, kStartSeconds);
  }
  return grid;
}

using Pick = double LatencyFigures::*;

Panel over_trips(const Grid& grid, const LatencyPlan& plan, double rate, Pick pick,
                 const std::string& label) {
  Panel panel{fmt::format("{:g} Mbit/s", rate), "round trip, ms", label, false, false, {}, {}, {}};
  for (const std::string& method : plan.methods) {
    Series series{method, {}};
    for (const double rtt : grid.trips) {
      if (const LatencyFigures* f = grid.find(method, rtt, rate)) {
        series.points.emplace_back(rtt, f->*pick);
      }
    }
    panel.series.push_back(series);
  }
  return panel;
}

Panel over_rates(const Grid& grid, const LatencyPlan& plan, double rtt, Pick pick,
                 const std::string& label) {
  Panel panel{
      fmt::format("round trip {:g} ms", rtt), "rate, Mbit/s", label, true, false, {}, {}, {}};
  for (const std::string& method : plan.methods) {
    Series series{method, {}};
    for (const double rate : grid.rates) {
      if (const LatencyFigures* f = grid.find(method, rtt, rate)) {
        series.points.emplace_back(rate, f->*pick);
      }
    }
    panel.series.push_back(series);
  }
  return panel;
}

std::vector<Panel> panels(const Grid& grid, const LatencyPlan& plan, Pick pick,
                          const std::string& label, std::optional<double> floor) {
  std::vector<Panel> out;
  for (const double rate : grid.rates) out.push_back(over_trips(grid, plan, rate, pick, label));
  for (const double rtt : grid.trips) {
    if (rtt >= 20) out.push_back(over_rates(grid, plan, rtt, pick, label));
  }
  for (Panel& panel : out) panel.floor = floor;
  return out;
}

// Returns the slope of the pose's age over the round trip, ms per ms, by least squares over all
// rates.
double slope(const Grid& grid, const std::string& method) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const double rtt : grid.trips) {
    for (const double rate : grid.rates) {
      const LatencyFigures* f = grid.find(method, rtt, rate);
      if (!f || !std::isfinite(f->pose_to_display_ms_p99)) continue;
      n += 1;
      sx += rtt;
      sy += f->pose_to_display_ms_p99;
      sxx += rtt * rtt;
      sxy += rtt * f->pose_to_display_ms_p99;
    }
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

void say_slopes(Page& page, const std::string& scene, const Grid& grid, const LatencyPlan& plan) {
  std::vector<std::string> lines;
  for (const std::string& method : plan.methods) {
    const double s = slope(grid, method);
    if (!std::isfinite(s)) continue;
    if (method == "mirage") {
      page.finding({fmt::format("{:.3f} ms", s),
                    scene + ": more delay from pose to display for each ms of round trip"});
    }
    lines.push_back(
        fmt::format("{}: pose to display grows by {:.3f} ms per ms of round trip", method, s));
  }
  page.list(lines);
}

// Says on which links of the grid another method is better at something, and by how much.
std::string where_better(const Grid& grid, const std::string& method, Pick pick, const char* what) {
  std::size_t links = 0;
  std::vector<std::string> where;
  double least = INFINITY, most = 0;
  for (const double rtt : grid.trips) {
    for (const double rate : grid.rates) {
      const LatencyFigures *own = grid.find("mirage", rtt, rate),
                           *other = grid.find(method, rtt, rate);
      if (!own || !other) continue;
      ++links;
      if (!(other->*pick < own->*pick)) continue;
      least = std::min(least, own->*pick - other->*pick);
      most = std::max(most, own->*pick - other->*pick);
      where.push_back(fmt::format("RTT {:g} at {:g} Mbit/s ({:.3g} against {:.3g})", rtt, rate,
                                  other->*pick, own->*pick));
    }
  }
  if (where.empty()) return fmt::format("{}: nowhere the lower {}.", method, what);
  if (where.size() == links) {
    return fmt::format("{}: on all {} links the lower {}, by {:.3g} to {:.3g}.", method, links,
                       what, least, most);
  }
  std::string line =
      fmt::format("{}: the lower {} on {} of {} links: ", method, what, where.size(), links);
  for (std::size_t i = 0; i < where.size(); ++i) line += (i == 0 ? "" : "; ") + where[i];
  return line + ".";
}

void say_where_others_win(Page& page, const Grid& grid, const LatencyPlan& plan) {
  std::vector<std::string> lines;
  for (const std::string& method : plan.methods) {
    if (method == "mirage") continue;
    lines.push_back(where_better(grid, method, &LatencyFigures::flip_mean, "mean FLIP"));
    lines.push_back(where_better(grid, method, &LatencyFigures::mbps, "rate used, Mbit/s"));
    lines.push_back(where_better(grid, method, &LatencyFigures::pose_to_display_ms_p99,
                                 "pose to display, ms p99"));
  }
  page.list(lines);
}

// Says where the aim (kAim) is met, and where it is missed, what the error consists of.
void say_aim(Page& page, const std::string& scene, const Grid& grid, double error_floor) {
  std::vector<std::string> met, missed;
  for (const double rtt : grid.trips) {
    for (const double rate : grid.rates) {
      const LatencyFigures *own = grid.find("mirage", rtt, rate),
                           *warp = grid.find("video+timewarp", rtt, rate);
      if (rtt < kLongTripMs || !own || !warp) continue;
      const double percent = 100 * (1 - own->flip_p95 / warp->flip_p95);
      const std::string line = fmt::format(
          "RTT {:g}, {:g} Mbit/s: {:.3f} against {:.3f}, {:.0f} % {}", rtt, rate, own->flip_p95,
          warp->flip_p95, std::abs(percent), percent >= 0 ? "under" : "over");
      if (own->flip_p95 <= kAim * warp->flip_p95) {
        met.push_back(line);
        continue;
      }
      const LatencyFigures* near = grid.find("mirage", *grid.trips.begin(), *grid.rates.rbegin());
      missed.push_back(
          line +
          (near ? fmt::format(". Of Mirage's error {:.3f} are there without any delay as well "
                              "(RTT {:g}, {:g} Mbit/s: drawing), {:.3f} come from lateness; "
                              "no picture of this size can be under {:.3f}",
                              near->flip_p95, *grid.trips.begin(), *grid.rates.rbegin(),
                              own->flip_p95 - near->flip_p95, error_floor)
                : ""));
    }
  }
  if (met.empty() && missed.empty()) return;
  page.finding({fmt::format("{} of {} links", met.size(), met.size() + missed.size()),
                fmt::format("{}: p95 FLIP at least 30 % under video with timewarp, from a round "
                            "trip of {:g} ms on",
                            scene, kLongTripMs),
                !missed.empty()});
  for (const std::string& line : missed) page.falls_short(scene + ": " + line);
  if (met.empty()) return;
  page.paragraph("p95 FLIP of Mirage beside video with timewarp, where the aim is met:");
  page.list(met);
}

}  // namespace

void show_latency(Context& context, const LatencyPlan& plan, const std::vector<LatencyRun>& runs,
                  double error_floor) {
  std::set<std::string> scenes;
  for (const LatencyRun& run : runs) scenes.insert(run.scene);
  std::size_t index = 0;
  for (const std::string& scene : scenes) {
    const Grid grid = grid_of(runs, scene);
    if (grid.at.empty()) continue;
    Page& page = context.page;
    page.heading(scene);
    const std::string walk = scene + ": ";
    context.plot(fmt::format("latency_flip_{}", index),
                 panels(grid, plan, &LatencyFigures::flip_p95, "FLIP, p95", error_floor), 3,
                 walk + "the picture's error against round trip and rate.");
    context.plot(fmt::format("latency_pose_{}", index),
                 panels(grid, plan, &LatencyFigures::pose_to_display_ms_p99,
                        "pose to display, ms p99", std::nullopt),
                 3, walk + "age of the viewpoint shown, against round trip and rate.");
    ++index;
    say_slopes(page, scene, grid, plan);
    page.paragraph("Where another method is better than Mirage:");
    say_where_others_win(page, grid, plan);
    say_aim(page, scene, grid, error_floor);
  }
}

}  // namespace mirage
