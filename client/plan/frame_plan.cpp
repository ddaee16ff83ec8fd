#include "client/plan/frame_plan.h"

#include <algorithm>
#include <cmath>

#include "protocol/base/order.h"
#include "protocol/impostor/camera.h"

namespace mirage {
namespace {

constexpr int kMostSamples = 4;
constexpr double kScales[] = {1, 0.75, 0.625, 0.5, 0.375, 0.25};
// Share of the budget that a frame is planned to take: its time is predictable to a few per cent.
constexpr double kPlannedShare = 0.95;
// Another setting must promise an error of at most this share, and the present one must have lasted
// this long.
constexpr double kBetterSetting = 0.9;
constexpr std::int64_t kSettingLastsUs = 500'000;
// Factor on the error of the way shown now, so that small gains do not change it. Ways differ by a
// tenth or two.
constexpr double kStays = 0.95;
// One frame in forty may take more than 1.1 times the budget. A late frame takes 6 % from what is
// planned, and one in time gives a 39th of that back (a quantile followed by stochastic
// approximation, Robbins and Monro 1951). After kPassed frames in time the strain has passed, and
// each frame gives back more.
constexpr double kLate = 1.1, kLateTakes = 0.06, kInTimeGives = kLateTakes / 39, kMostExcess = 3;
constexpr int kPassed = 80;
constexpr double kPassedGives = 0.01;
// Share of the last frame in the mean of the time that frames take beside drawing, and the largest
// share of the budget that the plan gives up for it.
constexpr double kBesideWeight = 1.0 / 16, kMostBeside = 0.5;
// Lambda falls by at most this factor a frame: what has just become affordable may not stay so, and
// is not asked for yet.
constexpr double kLambdaFalls = 0.8;
// A frame of an eye that has stood this long may take this many budgets, and at most this time, by
// which the first step may come late. Three budgets would be a frame that everybody sees stall.
constexpr std::int64_t kStandsLongUs = 250'000;
constexpr double kStandingBudgets = 2.5, kStandingMs = 120;
constexpr double kShortestMs = 1e-9;  // of a step, so that free steps come first
constexpr double kLeastLambda = 1;    // FLIP px a ms: as good as nothing

bool is_tile(Look look) { return look == Look::kFlat || look == Look::kDeep; }

// True if a change from one way to the other fades: between geometry and tiles.
bool crosses(Look from, Look to) {
  return (from == Look::kMesh && is_tile(to)) || (to == Look::kMesh && is_tile(from));
}

// True if a fade under way goes on when the thing is drawn this way.
bool goes_on(const Alternatives& thing, Look look) {
  return thing.leaving && thing.shown && !crosses(*thing.shown, look);
}

// Returns the mean FLIP of the things, weighted by area.
double flip_of(const std::vector<Alternatives>& things, const std::vector<Choice>& choices) {
  double error = 0, area = 0;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (!std::isfinite(choices[i].error) || !std::isfinite(things[i].area_px)) continue;
    error += choices[i].error;
    area += things[i].area_px;
  }
  return area > 0 ? error / area : 0;
}

}  // namespace

const char* look_name(Look look) {
  constexpr const char* kNames[] = {"nothing", "view", "flat", "depth", "mesh"};
  return kNames[static_cast<std::size_t>(look)];
}

FramePlan::FramePlan(double budget_ms, int samples) : budget_ms_(budget_ms) {
  const int most = samples < 0 ? kMostSamples : std::max(samples, 1);
  if (most > 1) settings_.push_back({most, 1});
  if (samples < 0 || most == 1) {
    for (const double scale : kScales) settings_.push_back({1, scale});
  }
  setting_ = drawn_ = settings_.front();
}

double FramePlan::ms_of(Work pixel, Work sample, double pixels, const FrameSetting& setting) const {
  if (!prices_) return 0;
  const double drawn = pixels * setting.scale * setting.scale;
  return drawn * ((*prices_)[pixel] + (setting.samples - 1) * (*prices_)[sample]);
}

Choice FramePlan::way(const Alternatives& thing, Look look, std::size_t index,
                      const FrameSetting& setting) const {
  Choice out;
  out.look = look;
  out.error = std::numeric_limits<double>::infinity();
  const int samples = setting.samples;
  switch (look) {
    case Look::kNothing:
      out.wrongs = nothing_wrongs(thing.area_px);
      break;
    case Look::kView:
      if (!thing.viewed) return out;
      out.wrongs = view_wrongs(thing.area_px);
      break;
    case Look::kFlat:
    case Look::kDeep: {
      const bool deep = look == Look::kDeep;
      const std::optional<Alternatives::Tile>& tile = deep ? thing.deep : thing.flat;
      if (!tile) return out;
      out.wrongs = tile_wrongs(thing.area_px, thing.alpha_tested, tile->error_px, tile->texel_px,
                               samples, setting.scale);
      out.ms = ms_of(deep ? Work::kReliefPixel : Work::kFlatPixel, Work::kImpostorSample,
                     thing.area_px * tile->share, setting);
      break;
    }
    case Look::kMesh: {
      if (index >= thing.levels.size()) return out;
      const Alternatives::Level& level = thing.levels[index];
      out.lod = level.lod;
      out.wrongs =
          mesh_wrongs(thing.area_px, thing.alpha_tested, level.error_px, samples, setting.scale);
      if (!prices_) break;
      const CostModel& p = *prices_;
      out.ms = thing.alpha_tested
                   ? level.triangles * (p[Work::kTestedTriangle] +
                                        (samples - 1) * p[Work::kTestedTriangleSample]) +
                         ms_of(Work::kTestedPixel, Work::kTestedSample, thing.area_px, setting)
                   : level.triangles * p[Work::kTriangle] +
                         thing.area_px * setting.scale * setting.scale * p[Work::kMeshPixel];
      break;
    }
  }
  out.error = thing.area_px * error_model().flip_of(out.wrongs);
  return out;
}

void FramePlan::ways_into(const Alternatives& thing, const FrameSetting& setting,
                          std::vector<Choice>& out) const {
  out.clear();
  const auto add = [&](const Choice& choice) {
    if (std::isfinite(choice.error)) out.push_back(choice);
  };
  const bool only_mesh = thing.mesh_only && !thing.levels.empty();
  if (!only_mesh) {
    // A tile is used wherever there is one; without a tile, the view tile if it errs less than a
    // placeholder.
    const Choice flat = way(thing, Look::kFlat, 0, setting);
    const Choice view = way(thing, Look::kView, 0, setting);
    const Choice nothing = way(thing, Look::kNothing, 0, setting);
    add(thing.flat ? flat : view.error < nothing.error ? view : nothing);
    add(way(thing, Look::kDeep, 0, setting));
  }
  for (std::size_t i = 0; i < thing.levels.size(); ++i) add(way(thing, Look::kMesh, i, setting));
  if (out.empty()) out.push_back({});  // its area is not finite
}

std::vector<Choice> FramePlan::ways(const Alternatives& thing, const FrameSetting& setting) const {
  std::vector<Choice> out;
  ways_into(thing, setting, out);
  return out;
}

double FramePlan::beneath_ms(const Alternatives& thing, Look look,
                             const FrameSetting& setting) const {
  if (!thing.shown) return 0;
  const bool changes = crosses(*thing.shown, look);
  if (!changes && !thing.leaving) return 0;
  const Choice beneath = way(thing, changes ? *thing.shown : *thing.leaving, 0, setting);
  return std::isfinite(beneath.error) ? beneath.ms : 0;
}

bool FramePlan::mesh_pays(const Alternatives& thing) const {
  const auto cost = [&](const Choice& choice) { return choice.error + lambda_ * choice.ms; };
  const Choice mesh = way(thing, Look::kMesh);
  return std::isfinite(mesh.error) && cost(mesh) <= cost(way(thing, Look::kFlat));
}

void FramePlan::stand(bool stands, std::int64_t now_us) {
  if (!stands) stands_since_us_.reset();
  if (stands && !stands_since_us_) stands_since_us_ = now_us;
  stands_long_ = stands && now_us - *stands_since_us_ >= kStandsLongUs;
}

void FramePlan::note_drawn(double ms, double beside_ms) {
  if (since_standing_ < kUnderWay) return;  // it may be the time of a standing eye's frame
  if (!limited() || !std::isfinite(ms) || ms <= 0 || expected_ms_ <= 0) return;
  if (!std::isfinite(beside_ms) || beside_ms < 0) return;
  beside_ms_ += kBesideWeight * (std::min(beside_ms, kMostBeside * budget_ms_) - beside_ms_);
  const bool late = ms + beside_ms > kLate * budget_ms_;
  // The quickest frame there is does not get quicker by planning less.
  if (late && expected_ms_ > planned_ms()) {
    in_time_ = 0;
    return;
  }
  in_time_ = late ? 0 : in_time_ + 1;
  const double gives = in_time_ > kPassed ? kPassedGives : kInTimeGives;
  excess_ = std::clamp(excess_ * (late ? 1 + kLateTakes : 1 - gives), 1.0, kMostExcess);
}

double FramePlan::planned_ms() const {
  return limited() ? kPlannedShare * (budget_ms_ - beside_ms_) / excess_
                   : std::numeric_limits<double>::infinity();
}

double FramePlan::frame_ms(const std::vector<Camera>& views,
                           const std::vector<Alternatives>& things,
                           const FrameSetting& setting) const {
  if (!prices_) return 0;
  const auto scaled = [&](std::uint32_t edge) {
    return static_cast<std::uint32_t>(std::lround(edge * setting.scale));
  };
  FrameWork frame;
  for (const Camera& view : views) {
    frame += target_work(view.at_size(scaled(view.width), scaled(view.height)), setting.samples);
  }
  const bool view_tile = std::any_of(things.begin(), things.end(), [](const Alternatives& thing) {
    return thing.viewed && !thing.flat && thing.levels.empty();
  });
  if (view_tile) frame[Work::kViewPixel] = frame[Work::kPixel];
  return prices_->ms_of(frame);
}

// Adds the cheapest way of a thing, and the steps to more expensive ones. Each step gains less a
// millisecond than the one before it.
void FramePlan::add_steps(std::uint32_t index, const Alternatives& thing,
                          const FrameSetting& setting, Outcome& out, Scratch& scratch) const {
  const std::vector<Choice>& ways = scratch.ways;
  std::vector<Scratch::Point>& points = scratch.points;
  ways_into(thing, setting, scratch.ways);
  points.clear();
  for (const Choice& choice : ways) {
    const bool stays = thing.shown == choice.look;
    // A fade to a cheaper way is not charged: its cost would keep the expensive way alive.
    const bool dearer =
        choice.look == Look::kMesh && thing.shown && crosses(*thing.shown, choice.look);
    points.push_back({(stays ? kStays : 1) * choice.error,
                      choice.ms + (dearer ? beneath_ms(thing, choice.look, setting) : 0)});
  }
  std::size_t at = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const bool better = points[i].ms < points[at].ms && thing.mesh_only;
    const bool free = points[i].ms <= points[at].ms && points[i].error < points[at].error;
    if (better || free) at = i;
  }
  out.choices.push_back(ways[at]);
  out.error += ways[at].error;
  out.ms += points[at].ms + out.levels.add(thing, ways[at]);
  if (goes_on(thing, ways[at].look)) out.ms += beneath_ms(thing, ways[at].look, setting);
  for (;;) {
    std::size_t next = at;
    double steepest = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double gain = points[at].error - points[i].error;
      if (!(gain > 0)) continue;
      const double ms = std::max(points[i].ms - points[at].ms, kShortestMs);
      if (gain / ms > steepest) {
        steepest = gain / ms;
        next = i;
      }
    }
    if (next == at) return;
    const Choice& to = ways[next];
    std::uint8_t level = 0;
    while (to.look == Look::kMesh && thing.levels[level].lod != to.lod) ++level;
    scratch.steps.push_back({points[at].error - points[next].error, points[next].ms - points[at].ms,
                             index, to.look, level});
    at = next;
  }
}

FramePlan::Outcome FramePlan::solve(const std::vector<Camera>& views,
                                    const std::vector<Alternatives>& things,
                                    const FrameSetting& setting) const {
  Outcome out;
  Scratch scratch;
  if (prices_) out.levels = PaidLevels((*prices_)[Work::kMesh]);
  out.ms = frame_ms(views, things, setting);
  out.choices.reserve(things.size());
  for (std::uint32_t i = 0; i < things.size(); ++i) add_steps(i, things[i], setting, out, scratch);
  // The new way is shown at once where there is no time to draw the way beneath.
  for (std::size_t i = 0; i < things.size() && out.ms > planned_ms(); ++i) {
    if (!goes_on(things[i], out.choices[i].look)) continue;
    out.choices[i].fades = false;
    out.ms -= beneath_ms(things[i], out.choices[i].look, setting);
  }
  take_steps(things, setting, scratch.steps, out);
  return out;
}

void FramePlan::take_steps(const std::vector<Alternatives>& things, const FrameSetting& setting,
                           std::vector<Step>& steps, Outcome& out) const {
  const double most = planned_ms();
  sort_descending(steps,
                  [](const Step& step) { return step.gain / std::max(step.ms, kShortestMs); });
  std::vector<bool> stopped(things.size(), false);
  for (const Step& step : steps) {
    if (stopped[step.thing]) continue;
    const Alternatives& thing = things[step.thing];
    Choice& choice = out.choices[step.thing];
    const Choice to = way(thing, step.look, step.level, setting);
    const double ms = step.ms + out.levels.change_ms(thing, choice, to);
    if (out.ms + ms > most) {
      // A later step may still fit; more expensive ways of this thing will not.
      stopped[step.thing] = true;
      out.lambda = std::max(out.lambda, step.gain / std::max(ms, kShortestMs));
      continue;
    }
    out.ms += ms;
    out.error += to.error - choice.error;
    out.levels.change(thing, choice, to);
    choice = to;
  }
}

// Lets changes from geometry to tiles fade as far as there is time left.
void FramePlan::fade(const std::vector<Alternatives>& things, Outcome& out) const {
  for (std::size_t i = 0; i < things.size(); ++i) {
    Choice& choice = out.choices[i];
    if (things[i].shown != Look::kMesh || !is_tile(choice.look)) continue;
    const double ms = beneath_ms(things[i], choice.look, setting_);
    choice.fades = out.ms + ms <= planned_ms();
    if (choice.fades) out.ms += ms;
  }
}

double FramePlan::ms_in(const FrameSetting& setting, const std::vector<Camera>& views,
                        const std::vector<Alternatives>& things, const Outcome& planned) const {
  double ms = planned.ms + frame_ms(views, things, setting) - frame_ms(views, things, setting_);
  for (std::size_t i = 0; i < things.size(); ++i) {
    const Choice& choice = planned.choices[i];
    std::size_t level = 0;
    while (choice.look == Look::kMesh && things[i].levels[level].lod != choice.lod) ++level;
    ms += way(things[i], choice.look, level, setting).ms - choice.ms;
  }
  return ms;
}

FrameSetting FramePlan::enlarged(const std::vector<Camera>& views,
                                 const std::vector<Alternatives>& things,
                                 const Outcome& planned) const {
  const double most_ms = std::min(kStandingBudgets * budget_ms_, std::max(kStandingMs, budget_ms_));
  for (const FrameSetting& setting : settings_) {
    if (setting == setting_) break;
    if (ms_in(setting, views, things, planned) <= most_ms) return setting;
  }
  return setting_;
}

const std::vector<Choice>& FramePlan::decide(const std::vector<Camera>& views,
                                             const std::vector<Alternatives>& things,
                                             std::int64_t now_us) {
  Outcome present = solve(views, things, setting_);
  const auto fits = [&](const Outcome& o) { return o.ms <= planned_ms(); };
  if (limited() && (now_us - changed_us_ >= kSettingLastsUs || !fits(present))) {
    for (const FrameSetting& setting : settings_) {
      if (setting == setting_) continue;
      Outcome other = solve(views, things, setting);
      // A setting that fits is better than one that does not. If neither fits, the quicker one is
      // better.
      const bool better = fits(other) != fits(present) ? fits(other)
                          : fits(other) ? other.error < kBetterSetting * present.error
                                        : other.ms < present.ms;
      if (!better) continue;
      present = std::move(other);
      setting_ = setting;
      changed_us_ = now_us;
    }
  }
  fade(things, present);
  lambda_ = std::max(present.lambda, lambda_ > kLeastLambda ? kLambdaFalls * lambda_ : 0);
  const bool enlarges = limited() && stands_long_;
  drawn_ = enlarges ? enlarged(views, things, present) : setting_;
  since_standing_ = enlarges ? 0 : std::min(since_standing_ + 1, kUnderWay);
  expected_ms_ = enlarges ? ms_in(drawn_, views, things, present) : present.ms;
  choices_ = std::move(present.choices);
  expected_flip_ = flip_of(things, choices_);
  return choices_;
}

}  // namespace mirage
