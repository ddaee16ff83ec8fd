#pragma once
// What the latency part runs and what it finds.

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
  int compare_every = 6;  ///< frames
};
LatencyPlan latency_plan(bool quick);

/// Frames before this are the start: connecting, the scene's description, the first tiles or the
/// first video frame. The table has what comes after; all frames are in a table of their own.
inline constexpr double kStartSeconds = 2;

struct LatencyFigures {
  double flip_mean = 0, flip_p95 = 0, pose_to_display_ms_p99 = 0, hole_fraction = 0;
  double mbps = 0;  ///< of the whole run
};
/// Over the samples from a time on; all NaN without any.
LatencyFigures figures_of(const LatencyRun& run, double from_seconds);

/// The contract's table, from a time on.
Table latency_table(const std::vector<LatencyRun>& runs, double from_seconds);

/// Plots, and what they say in words: where a baseline wins, the slope over the round trip, Mirage
/// against video with timewarp from a round trip of 100 ms on.
void show_latency(Context& context, const LatencyPlan& plan, const std::vector<LatencyRun>& runs,
                  double error_floor);

}  // namespace mirage
