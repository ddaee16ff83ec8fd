#pragma once
// Plan, figures and tables of the report's part about latency.

#include <string>
#include <vector>

#include "client/report/context.h"
#include "client/report/latency_run.h"

namespace mirage {

struct LatencyPlan {
  std::vector<std::string> scenes;
  std::vector<std::string> methods;
  std::vector<Condition> conditions;
  int width = 0, height = 0;
  double fps = 30, seconds = 4;
  int compare_every = 6;  ///< frames from one comparison to the next
};
LatencyPlan latency_plan(bool quick);

/// Length of the start, in which the client connects, receives the scene's description, and
/// receives its first tiles or its first video frame. The table leaves the start out; a second
/// table has all frames.
inline constexpr double kStartSeconds = 2;

struct LatencyFigures {
  double flip_mean = 0, flip_p95 = 0, pose_to_display_ms_p99 = 0, hole_fraction = 0;
  double mbps = 0;  ///< over the whole run
};
/// Returns the figures of the samples from a time on. All are NaN if there are none.
LatencyFigures figures_of(const LatencyRun& run, double from_seconds);

/// Returns a row for each run, over the samples from a time on.
Table latency_table(const std::vector<LatencyRun>& runs, double from_seconds);

/// Adds plots to the page, and sentences about them: where a baseline wins, the slope over the
/// round trip, and Mirage against video with timewarp for round trips of 100 ms and more.
void show_latency(Context& context, const LatencyPlan& plan, const std::vector<LatencyRun>& runs,
                  double error_floor);

}  // namespace mirage
