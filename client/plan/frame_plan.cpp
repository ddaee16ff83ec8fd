#include "client/plan/frame_plan.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

constexpr int kMostSamples = 4;
constexpr double kScales[] = {1, 0.75, 0.625, 0.5};
// A frame is planned to take so much of the budget: what it takes is known to a few per cent.
constexpr double kPlannedShare = 0.95;
// Another setting must promise so much less error, and the present one have lasted so long.
constexpr double kBetterSetting = 0.9;
constexpr std::int64_t kSettingLastsUs = 500'000;
constexpr double kClearly = 0.3;  // of error and price: less is no reason to draw a thing otherwise
constexpr double kExcessRises = 0.3, kExcessFalls = 0.15, kMostExcess = 1.5;  // a frame
constexpr double kLambdaFalls =
    0.8;  // a frame, at most: what has just become affordable may not stay
constexpr double kLeastLambda = 1;  // FLIP px a ms: as good as nothing

double sum(const CostModel& prices, const Alternatives& thing, const FrameSetting& setting,
           double share, Work pixel, Work sample) {
  const double pixels = thing.area_px * share * setting.scale * setting.scale;
  return pixels * (prices[pixel] + (setting.samples - 1) * prices[sample]);
}

}  // namespace

FramePlan::FramePlan(double budget_ms, int samples) : budget_ms_(budget_ms) {
  const int most = samples < 0 ? kMostSamples : std::max(samples, 1);
  if (most > 1) settings_.push_back({most, 1});
  if (samples < 0 || most == 1) {
    for (const double scale : kScales) settings_.push_back({1, scale});
  }
  setting_ = settings_.front();
}

FramePlan::Way FramePlan::mesh(const Alternatives& thing, const FrameSetting& setting) const {
  const CostModel& p = *prices_;
  Way way;
  if (!thing.mesh_px) return way;
  const int more = setting.samples - 1;
  way.ms =
      thing.alpha_tested
          ? thing.triangles * (p[Work::kTestedTriangle] + more * p[Work::kTestedTriangleSample]) +
                sum(p, thing, setting, 1, Work::kTestedPixel, Work::kTestedSample)
          : thing.triangles * p[Work::kTriangle] +
                thing.area_px * setting.scale * setting.scale * p[Work::kMeshPixel];
  way.error = thing.area_px * error_model().flip_of(mesh_wrongs(thing.alpha_tested, *thing.mesh_px,
                                                                setting.samples, setting.scale));
  return way;
}

FramePlan::Way FramePlan::tile(const Alternatives& thing,
                               const std::optional<Alternatives::Tile>& tile, bool deep,
                               const FrameSetting& setting) const {
  Way way;
  if (!tile) return way;
  way.ms = sum(*prices_, thing, setting, tile->share, deep ? Work::kReliefPixel : Work::kFlatPixel,
               Work::kImpostorSample);
  way.error = thing.area_px * error_model().flip_of(tile_wrongs(tile->error_px, tile->texel_px,
                                                                setting.samples, setting.scale));
  return way;
}

FramePlan::Way FramePlan::cheapest(const Alternatives& thing, const FrameSetting& setting) const {
  if (thing.mesh_only) return mesh(thing, setting);
  Way way = tile(thing, thing.flat, false, setting);
  const Wrongs else_shown = thing.view_px ? view_wrongs(*thing.view_px) : nothing_wrongs();
  const Way nothing{thing.area_px * error_model().flip_of(else_shown), 0};
  return nothing.error < way.error ? nothing : way;
}

bool FramePlan::pays(const Way& dear, const Way& cheap, bool drawn) const {
  const double gain = cheap.error - dear.error, price = lambda_ * (dear.ms - cheap.ms);
  // In units of what is at stake, as either side may be less than nothing.
  const double slack = kClearly * 0.5 * (std::abs(gain) + std::abs(price));
  return gain - price >= (drawn ? -slack : slack);
}

bool FramePlan::mesh_pays(const Alternatives& thing, bool drawn) const {
  if (thing.mesh_only) return true;
  const Way dear = mesh(thing, setting_);
  if (std::isinf(dear.error)) return false;
  Way cheap = cheapest(thing, setting_);
  if (march_pays(thing, false)) cheap = tile(thing, thing.deep, true, setting_);
  return pays(dear, cheap, drawn);
}

bool FramePlan::march_pays(const Alternatives& thing, bool drawn) const {
  if (!thing.deep) return false;
  return pays(tile(thing, thing.deep, true, setting_), cheapest(thing, setting_), drawn);
}

void FramePlan::note_drawn(double ms) {
  if (!plans() || !std::isfinite(ms) || ms <= 0 || expected_ms_ <= 0) return;
  const double excess = std::clamp(ms / expected_ms_, 1.0, kMostExcess);
  excess_ += (excess > excess_ ? kExcessRises : kExcessFalls) * (excess - excess_);
}

double FramePlan::planned_ms() const { return kPlannedShare * budget_ms_ / excess_; }

// From the cheapest way up, each step with less gain a millisecond than the one before it.
void FramePlan::add_steps(const Way& cheap, const Way& deep, const Way& mesh,
                          std::vector<Step>& steps) {
  const auto step = [](const Way& from, const Way& to) {
    // What is no dearer needs no budget.
    return Step{from.error - to.error, std::max(to.ms - from.ms, 0.0)};
  };
  const auto steeper = [](const Step& a, const Step& b) { return a.gain * b.ms > b.gain * a.ms; };
  const bool marches = deep.error < cheap.error, meshes = mesh.error < cheap.error;
  if (marches && mesh.error < deep.error) {
    const Step first = step(cheap, deep), second = step(deep, mesh);
    if (steeper(first, second)) {
      steps.push_back(first);
      steps.push_back(second);
      return;
    }
  }
  if (meshes && !(marches && deep.error <= mesh.error)) {
    steps.push_back(step(cheap, mesh));
  } else if (marches) {
    steps.push_back(step(cheap, deep));
  }
}

FramePlan::Outcome FramePlan::solve(const Camera& camera, const std::vector<Alternatives>& things,
                                    std::size_t levels, const FrameSetting& setting) const {
  Camera drawn = camera;
  drawn.width = static_cast<std::uint32_t>(std::lround(camera.width * setting.scale));
  drawn.height = static_cast<std::uint32_t>(std::lround(camera.height * setting.scale));
  FrameWork frame = target_work(drawn, setting.samples);
  frame[Work::kMesh] = static_cast<double>(levels);
  const bool views = std::any_of(things.begin(), things.end(), [](const Alternatives& thing) {
    return thing.view_px && !thing.flat && !thing.mesh_px;
  });
  if (views) frame[Work::kViewPixel] = frame[Work::kPixel];
  Outcome out;
  out.ms = prices_->ms_of(frame);
  std::vector<Step> steps;
  for (const Alternatives& thing : things) {
    const Way cheap = cheapest(thing, setting);
    out.error += cheap.error;
    out.ms += cheap.ms;
    add_steps(cheap, tile(thing, thing.deep, true, setting), mesh(thing, setting), steps);
  }
  std::sort(steps.begin(), steps.end(),
            [](const Step& a, const Step& b) { return a.gain * b.ms > b.gain * a.ms; });
  for (const Step& step : steps) {
    if (out.ms + step.ms > planned_ms()) {
      out.lambda = step.gain / step.ms;
      break;
    }
    out.ms += step.ms;
    out.error -= step.gain;
  }
  return out;
}

void FramePlan::finish(const Camera& camera, const std::vector<Alternatives>& things,
                       std::size_t levels, std::int64_t now_us) {
  if (!plans()) return;
  Outcome present = solve(camera, things, levels, setting_);
  const auto fits = [&](const Outcome& o) { return o.ms <= planned_ms(); };
  if (now_us - changed_us_ >= kSettingLastsUs || !fits(present)) {
    for (const FrameSetting& setting : settings_) {
      if (setting == setting_) continue;
      const Outcome other = solve(camera, things, levels, setting);
      // What fits comes before what does not; of what does not, the quicker.
      const bool better = fits(other) != fits(present) ? fits(other)
                          : fits(other) ? other.error < kBetterSetting * present.error
                                        : other.ms < present.ms;
      if (!better) continue;
      present = other;
      setting_ = setting;
      changed_us_ = now_us;
    }
  }
  lambda_ = std::max(present.lambda, lambda_ > kLeastLambda ? kLambdaFalls * lambda_ : 0);
  expected_ms_ = present.ms;
}

}  // namespace mirage
