#pragma once
// Settings whose error is measured against run time, and the tables and plots of the figures.

#include <optional>
#include <string>
#include <vector>

#include "client/plan/frame_plan.h"
#include "client/report/plot.h"
#include "client/report/table.h"

namespace mirage {

/// A setting: the method and limits of a session.
struct Setting {
  std::string method;
  double tau_px = 1;
  int samples = 4;       ///< per pixel; < 0: the plan chooses
  double budget_ms = 0;  ///< time budget of a frame; 0: none
  bool pictured = false;

  bool automatic() const { return method == "auto"; }
  /// Returns a name such as "quad at tau 1 px, 4 samples" or "auto within 33 ms".
  std::string name() const;
  /// Returns the name of the setting's line in the plots.
  std::string series() const;
};

struct Sweep {
  std::vector<std::string> scenes;
  std::vector<Setting> settings;  ///< in the order in which they run
  int width, height;
  double fps;
  int frames;
  std::vector<int> compared;  ///< compared frames; the last two follow each other, for flicker
};
/// Returns the sweep. `methods`: the names of all methods (client/host/methods.h).
Sweep work_sweep(bool quick, const std::vector<std::string>& methods);

/// Figures of one setting; nullopt if the method has none.
struct Figures {
  Setting setting;
  /// median over the frames of each one's quickest draw
  double client_ms = 0;
  std::optional<double> client_ms_p95;        ///< by the device model
  std::optional<FrameSetting> frame_setting;  ///< the one that most frames had
  std::optional<double> server_ms, display_ms, e1_p99, e1_max;
  double bytes_per_s = 0;
  std::optional<double> flip, psnr, ssim, iou, flicker;
  std::vector<double> spreads;  ///< slowest over quickest draw, one per compared frame
};

enum class Cost { kClientMs, kModelMs, kBytesPerS };  ///< kModelMs: client_ms_p95
double cost_of(const Figures& figures, Cost cost);
/// Tells which settings are on the front of this cost and FLIP.
std::vector<bool> front_by(const std::vector<Figures>& all, Cost cost);
/// Returns the median over all frames of the slowest draw over the quickest, less 1.
double spread_of(const std::vector<Figures>& all);

/// A setting of a fixed method that reaches its error at less cost than auto does.
struct LeftOfAuto {
  std::size_t index = 0;
  /// cost of auto at that error, between two settings of its front; infinite: never reached
  double auto_cost = 0;
};
/// Returns these settings. A cost counts as less only if it is less by more than `slack`, relative.
std::vector<LeftOfAuto> left_of_auto(const std::vector<Figures>& all, Cost cost, double slack);
/// Returns a sentence about left_of_auto().
std::string say_of_auto(const std::vector<Figures>& all, Cost cost, double slack);

/// Errors of the full render with fewer samples, which no method can be expected to beat.
struct Floor {
  std::optional<double> flip, iou_error, flicker;
};
/// Plot of an error: "e1" (geometric), "e2" (FLIP), "e4" (coverage) or "e6" (flicker), with a panel
/// for each cost.
struct ErrorPlot {
  std::string id, label;
  std::vector<Panel> panels;
};
std::vector<ErrorPlot> error_plots(const std::vector<Figures>& all, const Floor& floor);

Table work_precision_table();
struct RowOrigin {
  std::string scene, commit, renderer, revision;
};
void add_rows(Table& table, const std::vector<Figures>& all, const RowOrigin& origin);
/// Returns each setting that is not on the front by client ms, with a setting that beats it.
Table dominated_settings(const std::vector<Figures>& all);

}  // namespace mirage
