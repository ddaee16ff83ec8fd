#pragma once
// The settings that error against run time is measured of, and what is made of their figures.

#include <optional>
#include <string>
#include <vector>

#include "client/plan/frame_plan.h"
#include "client/report/plot.h"
#include "client/report/table.h"

namespace mirage {

/// What a session is run with.
struct Setting {
  std::string method;
  double tau_px = 1;
  int samples = 4;       ///< of a pixel; < 0: as the plan has it
  double budget_ms = 0;  ///< of a frame; 0: none
  bool pictured = false;

  bool automatic() const { return method == "auto"; }
  /// "quad at tau 1 px, 4 samples", "auto within 33 ms".
  std::string name() const;
  /// Of its line in the plots.
  std::string series() const;
};

struct Sweep {
  std::vector<std::string> scenes;
  std::vector<Setting> settings;  ///< in the order in which they are run
  int width, height;
  double fps;
  int frames;
  std::vector<int> compared;  ///< the last two in turn, for flicker
};
/// `methods`: all names (client/host/methods.h).
Sweep work_sweep(bool quick, const std::vector<std::string>& methods);

/// One setting's figures; n/a where a method has none.
struct Figures {
  Setting setting;
  double client_ms = 0;                       ///< median over frames of their quickest draws
  std::optional<double> client_ms_p95;        ///< by the device model
  std::optional<FrameSetting> frame_setting;  ///< that most frames had
  std::optional<double> server_ms, display_ms, e1_p99, e1_max;
  double bytes_per_s = 0;
  std::optional<double> flip, psnr, ssim, iou, flicker;
  std::vector<double> spreads;  ///< slowest over quickest draw, one per compared frame
};

enum class Cost { kClientMs, kModelMs, kBytesPerS };  ///< kModelMs: client_ms_p95
double cost_of(const Figures& figures, Cost cost);
/// By this cost and FLIP, of all settings.
std::vector<bool> front_by(const std::vector<Figures>& all, Cost cost);
/// The slowest of a frame's draws over its quickest, in the median over all frames, less 1.
double spread_of(const std::vector<Figures>& all);

/// A fixed method's setting that shows its error for less than auto does.
struct LeftOfAuto {
  std::size_t index = 0;
  double auto_cost = 0;  ///< between the settings of its front; infinite: it never errs so little
};
/// `slack`: by so much more the cost may differ before it counts, relative.
std::vector<LeftOfAuto> left_of_auto(const std::vector<Figures>& all, Cost cost, double slack);
/// What that says, in a sentence.
std::string say_of_auto(const std::vector<Figures>& all, Cost cost, double slack);

/// What no method can be expected to beat; the full render with fewer samples.
struct Floor {
  std::optional<double> flip, iou_error, flicker;
};
/// For "e1" (geometric), "e2" (FLIP), "e4" (coverage) and "e6" (flicker), a panel for each cost.
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
/// Each setting that is not on the front by client ms, with one that beats it.
Table dominated_settings(const std::vector<Figures>& all);

}  // namespace mirage
