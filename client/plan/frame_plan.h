#pragma once
// Frame plan: which of the dearer ways to draw things pay within a budget of milliseconds a frame,
// and with how many samples a pixel and at which scale the frame is drawn.
// Input:  what each visible thing may be drawn as, with what error; prices; the budget. Output: the
//         price of error (lambda) that the next frame decides by, and its setting.
// Thread: the frame loop's. Never full: one value a thing and frame.
//
// Minimises the sum of errors (FLIP times pixels) under the budget: a multiple-choice knapsack
// (T. A. Funkhouser, C. H. Sequin, SIGGRAPH 93). Each thing has a cheapest way and one that errs
// less for more; those go first that take away most error a millisecond. The last that fits is
// lambda: what a millisecond has to take away. A budget that everything fits in has lambda 0.

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "client/price/cost_model.h"
#include "client/price/error_model.h"

namespace mirage {

/// How a whole frame is drawn.
struct FrameSetting {
  int samples = 1;   ///< of a pixel
  double scale = 1;  ///< of its width and height, over those that are shown
  bool operator==(const FrameSetting& o) const { return samples == o.samples && scale == o.scale; }
};

/// What a visible thing may be drawn as. Errors in px; a way that is not there is nullopt.
struct Alternatives {
  struct Tile {
    double error_px = 0, texel_px = 0;
    double share = 1;  ///< of the thing's area
  };
  double area_px = 0;  ///< of its disc, as far as it is in view (shown_area_px)
  bool alpha_tested = false;
  double triangles = 0;  ///< of the level of geometry that would be drawn
  std::optional<double> mesh_px;
  bool mesh_only = false;  ///< it is what one stands in, or no picture can stand for it
  std::optional<Tile> flat, deep;
  std::optional<double> view_px;
};

class FramePlan {
 public:
  /// `budget_ms` of a frame; 0: any time, and nothing is planned. `samples` of a pixel; < 0: as
  /// many as pay.
  FramePlan(double budget_ms, int samples);

  /// Prices of this device from now on.
  void set_prices(const CostModel& prices) { prices_ = prices; }
  /// There is a budget, and prices are known.
  bool plans() const { return budget_ms_ > 0 && prices_.has_value(); }

  /// Whether geometry takes away enough error for what it costs more than the best of the others.
  /// `drawn`: it is what is drawn, and stays unless something else is clearly better.
  bool mesh_pays(const Alternatives& thing, bool drawn) const;
  /// The same of marching depth beside the flat tile.
  bool march_pays(const Alternatives& thing, bool drawn) const;

  /// All things of a frame have been considered: decides for the next one. `levels`: of geometry in
  /// the frame.
  void finish(const Camera& camera, const std::vector<Alternatives>& things, std::size_t levels,
              std::int64_t now_us);

  /// The frame planned last has taken so long, or would have. What fades in beside what was there,
  /// and what nobody foresaw, is kept room for from then on.
  void note_drawn(double ms);

  const FrameSetting& setting() const { return setting_; }
  /// FLIP times pixels that a millisecond has to take away.
  double lambda() const { return lambda_; }
  /// What the next frame is expected to take, ms.
  double expected_ms() const { return expected_ms_; }

 private:
  /// One way to draw a thing in a setting.
  struct Way {
    double error = std::numeric_limits<double>::infinity();  ///< FLIP times px
    double ms = 0;
  };
  bool pays(const Way& dear, const Way& cheap, bool drawn) const;
  double planned_ms() const;
  struct Step {
    double gain = 0, ms = 0;
  };
  struct Outcome {
    double error = 0, ms = 0, lambda = 0;
  };
  Way mesh(const Alternatives& thing, const FrameSetting& setting) const;
  Way tile(const Alternatives& thing, const std::optional<Alternatives::Tile>& tile, bool deep,
           const FrameSetting& setting) const;
  /// Without geometry, without marching.
  Way cheapest(const Alternatives& thing, const FrameSetting& setting) const;
  static void add_steps(const Way& cheap, const Way& deep, const Way& mesh,
                        std::vector<Step>& steps);
  Outcome solve(const Camera& camera, const std::vector<Alternatives>& things, std::size_t levels,
                const FrameSetting& setting) const;

  double budget_ms_;
  std::vector<FrameSetting> settings_;
  std::optional<CostModel> prices_;
  FrameSetting setting_;
  double lambda_ = 0;
  double expected_ms_ = 0;
  double excess_ = 1;  ///< what frames take lately, over what was expected, >= 1
  std::int64_t changed_us_ = INT64_MIN / 2;  ///< when the setting last changed
};

}  // namespace mirage
