#pragma once
// Frame plan: decides how each visible thing is drawn within a budget of milliseconds a frame, with
// how many samples a pixel, and at which scale.
// Input:  the ways in which each thing may be drawn, prices, the budget.
// Output: a choice for each thing, the frame's setting, and the price of error (lambda) that asks
//         are judged by.
// Thread: the frame loop's.
// Full:   never; one choice a thing and frame.
//
// It minimises the sum of errors (FLIP times pixels) under the budget: a multiple-choice knapsack
// (T. A. Funkhouser, C. H. Sequin, SIGGRAPH 93). Each thing begins with its cheapest way. Steps to
// more expensive ways are taken in the order of the error that they take away a millisecond. The
// first step that does not fit sets lambda: the error that a millisecond has to take away. Without
// a budget lambda is 0.

#include "client/frame/frame_setting.h"
#include "client/plan/alternatives.h"
#include "client/plan/paid_levels.h"
#include "client/price/cost_model.h"

namespace mirage {

class FramePlan {
 public:
  /// `budget_ms` is the budget of a frame; 0: any time. `samples` of a pixel; < 0: as many as pay.
  FramePlan(double budget_ms, int samples);

  /// Sets the budget of a frame; 0: any time.
  void set_budget(double ms) { budget_ms_ = ms; }
  /// Sets the prices of this device. Until then, and without a budget, everything fits.
  void set_prices(const CostModel& prices) { prices_ = prices; }
  /// True if there is a budget and prices are known.
  bool limited() const { return budget_ms_ > 0 && prices_.has_value(); }

  /// Decides how the things of a frame are drawn: those of all its views, one after the other.
  /// Returns one choice a thing, in their order.
  const std::vector<Choice>& decide(const std::vector<Camera>& views,
                                    const std::vector<Alternatives>& things, std::int64_t now_us);
  /// Returns the choices of the last decide().
  const std::vector<Choice>& choices() const { return choices_; }
  /// True if, at the present lambda, a thing is better drawn as geometry of its first level than
  /// from its flat tile. The geometry need not be here yet.
  bool mesh_pays(const Alternatives& thing) const;
  /// Returns one way to draw a thing in the present setting; an error of +inf: it is not possible.
  Choice way(const Alternatives& thing, Look look, std::size_t level = 0) const {
    return way(thing, look, level, setting_);
  }
  /// Returns all possible ways to draw a thing.
  std::vector<Choice> ways(const Alternatives& thing, const FrameSetting& setting) const;

  /// Notes whether the eye stands and nothing in view moves. A picture of it may take several
  /// budgets, because nobody sees it late: it is drawn at a larger scale. Things are drawn in the
  /// ways that fit one budget, so that the first step changes the scale alone.
  void stand(bool stands, std::int64_t now_us);

  /// Learns that a frame took `ms` to draw, or would have taken it, and `beside_ms` for everything
  /// else, such as taking tiles in and planning. That is taken from the budget first. The plan
  /// keeps room for surprises, so that one frame in forty takes longer than 1.1 times the budget.
  void note_drawn(double ms, double beside_ms = 0);

  const FrameSetting& setting() const { return drawn_; }
  double budget_ms() const { return budget_ms_; }
  /// Returns the error, FLIP times pixels, that a millisecond has to take away.
  double lambda() const { return lambda_; }
  /// Returns the most that is planned for drawing, ms: the budget without what is beside it and
  /// without the room kept; +inf without a budget.
  double planned_ms() const;
  /// Returns the expected time of the frame, ms; 0 without prices.
  double expected_ms() const { return expected_ms_; }
  /// Returns the error that the things of the frame are expected to show, beside the proven bound:
  /// FLIP a pixel, 0 to 1, the mean over their areas (error_model.h). 0: nothing is in view.
  double expected_flip() const { return expected_flip_; }

 private:
  static constexpr int kUnderWay = 2;  ///< frames drawn whose time is not known yet

  /// A step of a thing to a more expensive way.
  struct Step {
    double gain = 0, ms = 0;
    std::uint32_t thing = 0;
    Look look = Look::kNothing;
    std::uint8_t level = 0;  ///< index into Alternatives::levels
  };
  struct Outcome {
    double error = 0, ms = 0, lambda = 0;
    std::vector<Choice> choices;
    PaidLevels levels{0};  ///< levels of geometry that the choices draw
  };
  /// Scratch of solve(), which takes memory once and not for each thing.
  struct Scratch {
    struct Point {
      double error, ms;
    };
    std::vector<Choice> ways;   ///< of one thing
    std::vector<Point> points;  ///< of its ways
    std::vector<Step> steps;    ///< of all things
  };
  double ms_of(Work pixel, Work sample, double pixels, const FrameSetting& setting) const;
  Choice way(const Alternatives& thing, Look look, std::size_t level,
             const FrameSetting& setting) const;
  /// Replaces `out` by all possible ways to draw a thing.
  void ways_into(const Alternatives& thing, const FrameSetting& setting,
                 std::vector<Choice>& out) const;
  /// Returns the time of what is drawn beneath a fade, ms; 0 if nothing is.
  double beneath_ms(const Alternatives& thing, Look look, const FrameSetting& setting) const;
  double frame_ms(const std::vector<Camera>& views, const std::vector<Alternatives>& things,
                  const FrameSetting& setting) const;
  void add_steps(std::uint32_t index, const Alternatives& thing, const FrameSetting& setting,
                 Outcome& out, Scratch& scratch) const;
  Outcome solve(const std::vector<Camera>& views, const std::vector<Alternatives>& things,
                const FrameSetting& setting) const;
  /// Takes the steps that fit, in the order of their gain a millisecond.
  void take_steps(const std::vector<Alternatives>& things, const FrameSetting& setting,
                  std::vector<Step>& steps, Outcome& out) const;
  void fade(const std::vector<Alternatives>& things, Outcome& out) const;
  /// Returns the time of a planned frame in another setting, ms.
  double ms_in(const FrameSetting& setting, const std::vector<Camera>& views,
               const std::vector<Alternatives>& things, const Outcome& planned) const;
  /// Returns the best setting in which the planned frame fits the budgets of a standing eye.
  FrameSetting enlarged(const std::vector<Camera>& views, const std::vector<Alternatives>& things,
                        const Outcome& planned) const;

  double budget_ms_;
  std::vector<FrameSetting> settings_;
  std::optional<CostModel> prices_;
  FrameSetting setting_;  ///< that fits one budget
  FrameSetting drawn_;    ///< that frames are drawn in
  std::vector<Choice> choices_;
  double lambda_ = 0;
  double expected_ms_ = 0, expected_flip_ = 0;
  int in_time_ = 0;       ///< frames since the last late one
  double excess_ = 1;     ///< room for surprises: the budget over what is planned, >= 1
  double beside_ms_ = 0;  ///< of a frame, for all but drawing: mean of late, at most half a budget
  std::int64_t changed_us_ = INT64_MIN / 2;  ///< when the setting last changed
  std::optional<std::int64_t> stands_since_us_;
  bool stands_long_ = false;
  int since_standing_ = kUnderWay;  ///< frames planned since the eye stood, at most kUnderWay
};

}  // namespace mirage
