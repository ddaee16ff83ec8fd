#pragma once
// Plan, figures and tables of the report's part about frames by the wall clock.

#include <optional>
#include <string>
#include <vector>

#include "client/report/plot.h"
#include "client/report/table.h"

namespace mirage {

struct RealPlan {
  std::vector<std::string> scenes;
  std::vector<double> budgets_ms;  ///< rising
  int width = 0, height = 0;
  double seconds = 0;  ///< length of a walk; longer than the 5 s after which frames are settled
};
RealPlan real_plan(bool quick);

/// Times of frames, ms. NaN: no frame was drawn.
struct FrameTimes {
  double p50 = 0, p95 = 0, longest = 0;
};

/// A stage of frames (FrameStage).
struct RealStage {
  std::string name;
  FrameTimes ms;
  int late = 0;  ///< late frames that this stage caused
};

/// A walk within a budget. Settled figures count from the fifth second on. NaN: not measured.
struct RealRun {
  std::string scene;
  double budget_ms = 0;
  int frames = 0;
  FrameTimes ms, settled_ms;
  int late = 0;       ///< frames that took longer than 1.1 budgets
  int very_late = 0;  ///< frames that took longer than 3 budgets, the first one apart
  std::vector<RealStage> stages;
  double placeholders = 0, settled_placeholders = 0;  ///< share of the objects in view
  double scale = 0, samples = 0;                      ///< mean of frames
  double first_picture_ms = 0;
  std::string renderer;  ///< of the viewer

  /// True if 95 of 100 settled frames are not late.
  bool held() const;
  /// Returns the stage that caused most late frames; "none" if no frame is late.
  std::string worst_stage() const;
};

/// Reads the two files that mirage-view --stats writes. Returns nullopt if they are not as
/// expected.
std::optional<RealRun> read_real_run(const std::string& statistics, const std::string& real_time);

/// Returns a row for each run.
Table real_table(const std::vector<RealRun>& runs);
/// Returns a row for each stage of each run.
Table real_stages(const std::vector<RealRun>& runs);

/// Returns plots against the budget. Frames have two panels for each scene: the whole walk, and
/// from the fifth second on. The others have one.
std::vector<Panel> frame_panels(const std::vector<RealRun>& runs);
std::vector<Panel> late_panels(const std::vector<RealRun>& runs);
std::vector<Panel> picture_panels(const std::vector<RealRun>& runs);

}  // namespace mirage
