#pragma once
// Frame plan: how each visible thing is drawn within a budget of milliseconds a frame, with how
// many samples a pixel, and at which scale.
// Input:  what each thing may be drawn as, prices, the budget. Output: a choice for each, the
//         frame's setting, and the price of error (lambda) that asks are judged by.
// Thread: the frame loop's. Never full: one choice a thing and frame.
//
// Minimises the sum of errors (FLIP times pixels) under the budget: a multiple-choice knapsack
// (T. A. Funkhouser, C. H. Sequin, SIGGRAPH 93). Each thing begins with its cheapest way; steps to
// dearer ones are taken in the order of the error they take away a millisecond. The first that
// does not fit is lambda: what a millisecond has to take away. Without a budget lambda is 0.

#include "client/plan/alternatives.h"
#include "client/plan/paid_levels.h"
#include "client/price/cost_model.h"

namespace mirage {

/// How a whole frame is drawn.
struct FrameSetting {
  int samples = 1;   ///< of a pixel
  double scale = 1;  ///< of its width and height, over those that are shown
  bool operator==(const FrameSetting& o) const { return samples == o.samples && scale == o.scale; }
};

class FramePlan {
 public:
  /// `budget_ms` of a frame; 0: any time. `samples` of a pixel; < 0: as many as pay.
  FramePlan(double budget_ms, int samples);

  /// Prices of this device from now on. Until then, and without a budget, everything fits.
  void set_prices(const CostModel& prices) { prices_ = prices; }
  /// There is a budget, and prices are known.
  bool limited() const { return budget_ms_ > 0 && prices_.has_value(); }

  /// Decides how the things of a frame are drawn, one choice a thing.
  const std::vector<Choice>& decide(const Camera& camera, const std::vector<Alternatives>& things,
                                    std::int64_t now_us);
  /// The same for one thing that is not there yet, at the present lambda: whether as geometry of
  /// this level it would be better drawn than as any of its other ways.
  bool mesh_pays(const Alternatives& thing) const;
  /// One way to draw a thing, in the present setting; an error of +inf: it is not there.
  Choice way(const Alternatives& thing, Look look, std::size_t level = 0) const {
    return way(thing, look, level, setting_);
  }
  /// All ways there are.
  std::vector<Choice> ways(const Alternatives& thing, const FrameSetting& setting) const;

  /// A frame has taken so long, or would have: room is kept for what nobody foresaw, so that one in
  /// forty takes longer than 1.1 times the budget.
  void note_drawn(double ms);

  const FrameSetting& setting() const { return setting_; }
  double budget_ms() const { return budget_ms_; }
  /// FLIP times pixels that a millisecond has to take away.
  double lambda() const { return lambda_; }
  /// What is planned at most, ms: the budget without the room that is kept; +inf without one.
  double planned_ms() const;
  /// What the frame is expected to take, ms; 0 without prices.
  double expected_ms() const { return expected_ms_; }

 private:
  /// A step of a thing to a dearer way.
  struct Step {
    double gain = 0, ms = 0;
    std::uint32_t thing = 0;
    Look look = Look::kNothing;
    std::uint8_t level = 0;  ///< index into Alternatives::levels
  };
  struct Outcome {
    double error = 0, ms = 0, lambda = 0;
    std::vector<Choice> choices;
    PaidLevels levels{0};  ///< of geometry, that the choices draw
  };
  double ms_of(Work pixel, Work sample, double pixels, const FrameSetting& setting) const;
  Choice way(const Alternatives& thing, Look look, std::size_t level,
             const FrameSetting& setting) const;
  /// What goes on beneath, ms: 0 where nothing does.
  double beneath_ms(const Alternatives& thing, Look look, const FrameSetting& setting) const;
  double frame_ms(const Camera& camera, const std::vector<Alternatives>& things,
                  const FrameSetting& setting) const;
  void add_steps(std::uint32_t index, const Alternatives& thing, const FrameSetting& setting,
                 Outcome& out, std::vector<Step>& steps) const;
  Outcome solve(const Camera& camera, const std::vector<Alternatives>& things,
                const FrameSetting& setting) const;
  /// Takes the steps that fit, those first that gain most a millisecond.
  void take_steps(const std::vector<Alternatives>& things, const FrameSetting& setting,
                  std::vector<Step>& steps, Outcome& out) const;
  void fade(const std::vector<Alternatives>& things, Outcome& out) const;

  double budget_ms_;
  std::vector<FrameSetting> settings_;
  std::optional<CostModel> prices_;
  FrameSetting setting_;
  std::vector<Choice> choices_;
  double lambda_ = 0;
  double expected_ms_ = 0;
  int in_time_ = 0;    ///< frames since the last one that was late
  double excess_ = 1;  ///< room for what nobody foresaw: the budget over what is planned, >= 1
  std::int64_t changed_us_ = INT64_MIN / 2;  ///< when the setting last changed
};

}  // namespace mirage
