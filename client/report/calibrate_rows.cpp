#include "client/report/calibrate_rows.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "client/frame/draw_list.h"
#include "client/plan/frame_plan.h"
#include "client/price/running_fit.h"
#include "client/scene/scene_view.h"

namespace mirage {
namespace {

constexpr double kLeastPixels = 64;
constexpr double kLeastCoefficient = 1e-3;  // a factor cannot raise 0
constexpr double kCoefficientRange = 1000;
constexpr double kPrior = 1e-9;  // for what no sample has

// The thing that stands for an instance: itself, or the group it is in.
std::uint32_t standing_for(const SceneView& scene, std::uint32_t id,
                           const std::unordered_map<std::uint32_t, std::size_t>& things) {
  std::uint32_t instance = scene.index_of(id);
  while (instance != InstanceView::kNoParent && things.count(instance) == 0) {
    instance = scene.instances[instance].parent;
  }
  return instance;
}

std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> out(values.size());
  for (std::size_t from = 0; from < order.size();) {
    std::size_t to = from;
    while (to < order.size() && values[order[to]] == values[order[from]]) ++to;
    const double shared = 0.5 * static_cast<double>(from + to - 1);
    for (std::size_t i = from; i < to; ++i) out[order[i]] = shared;
    from = to;
  }
  return out;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n;
  const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

}  // namespace

std::vector<ErrorSample> samples_of(const ObservedFrame& frame, const std::string& scene) {
  const std::optional<FlipMap> flip = flip_map(frame.due, frame.seen);
  const std::vector<Choice>& chosen = frame.plan.choices();
  const std::vector<Alternatives>& considered = frame.considered;
  std::vector<ErrorSample> out(chosen.size());
  std::unordered_map<std::uint32_t, std::size_t> things;
  std::vector<bool> mixed(chosen.size(), false);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const bool twice = !things.emplace(considered[i].instance, i).second;
    mixed[i] = twice || considered[i].leaving.has_value();
    out[i].scene = scene;
    out[i].look = chosen[i].look;
    out[i].wrongs = chosen[i].wrongs;
    out[i].area_px = considered[i].area_px;
  }
  for (const DrawnMesh& mesh : frame.list.meshes) {
    const auto at = things.find(mesh.instance);
    if (at != things.end() && (mesh.fade < 1 || mesh.plain)) mixed[at->second] = true;
  }
  for (const DrawnImpostor& drawn : frame.list.impostors) {
    const auto at = things.find(drawn.instance);
    if (at != things.end() && drawn.fade < 1) mixed[at->second] = true;
  }
  std::unordered_map<std::uint32_t, std::uint32_t> by_id;
  for (std::size_t p = 0; flip && p < frame.truth.ids.size(); ++p) {
    const std::uint32_t id = frame.truth.ids[p];
    if (id == 0 || id > frame.scene.all_instances) continue;
    auto at = by_id.find(id);
    if (at == by_id.end()) {
      at = by_id.emplace(id, standing_for(frame.scene, id - 1, things)).first;
    }
    if (at->second == InstanceView::kNoParent) continue;
    ErrorSample& sample = out[things.at(at->second)];
    ++sample.pixels;
    sample.flip += double{flip->error[p]};
  }
  std::vector<ErrorSample> kept;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (mixed[i] || out[i].pixels < kLeastPixels) continue;
    out[i].flip /= out[i].pixels;
    kept.push_back(std::move(out[i]));
  }
  return kept;
}

ErrorModel fitted_errors(const std::vector<ErrorSample>& samples, const ErrorModel& first) {
  RunningFitOptions options;
  options.kept = 1;
  options.range = kCoefficientRange;
  options.prior = kPrior;
  RunningFit<kWrongs> fit(options);
  Wrongs start{};
  for (std::size_t k = 0; k < kWrongs; ++k) start[k] = std::max(first.flip[k], kLeastCoefficient);
  for (const ErrorSample& sample : samples) {
    Wrongs row{};
    for (std::size_t k = 0; k < kWrongs; ++k) row[k] = sample.wrongs[k] * start[k];
    // Between a thing's weight and a pixel's: large ones are few, and small ones all alike.
    fit.add(row, sample.flip, std::sqrt(sample.pixels));
  }
  for (int i = 0; i < 1000; ++i) fit.add({}, 0, 0);  // on to where it does not move any more
  ErrorModel out;
  for (std::size_t k = 0; k < kWrongs; ++k) out.flip[k] = start[k] * fit.factors()[k];
  return out;
}

RankCorrelation rank_correlation(const std::vector<ErrorSample>& samples, const ErrorModel& model) {
  if (samples.size() < 3) return {};
  std::vector<double> errors, flips, measured_errors, measured_flips;
  for (const ErrorSample& sample : samples) {
    const double flip = model.flip_of(sample.wrongs);
    errors.push_back(flip * sample.area_px);
    flips.push_back(flip);
    measured_errors.push_back(sample.flip * sample.pixels);
    measured_flips.push_back(sample.flip);
  }
  return {correlation(ranks(errors), ranks(measured_errors)),
          correlation(ranks(flips), ranks(measured_flips))};
}

double mean_excess(const std::vector<ErrorSample>& samples, const ErrorModel& model) {
  double sum = 0, pixels = 0;
  for (const ErrorSample& sample : samples) {
    sum += sample.pixels * (sample.flip - model.flip_of(sample.wrongs));
    pixels += sample.pixels;
  }
  return pixels > 0 ? sum / pixels : 0;
}

Table calibration_csv(const std::vector<ErrorSample>& samples, const ErrorModel& model) {
  std::vector<std::string> head = {"scene", "look", "area_px", "pixels", "flip", "predicted"};
  for (std::size_t k = 0; k < kWrongs; ++k) head.push_back(wrong_name(static_cast<Wrong>(k)));
  Table table(head);
  for (const ErrorSample& sample : samples) {
    std::vector<std::string> row = {sample.scene,
                                    look_name(sample.look),
                                    fmt::format("{:.0f}", sample.area_px),
                                    fmt::format("{:.0f}", sample.pixels),
                                    fmt::format("{:.5f}", sample.flip),
                                    fmt::format("{:.5f}", model.flip_of(sample.wrongs))};
    for (const double wrong : sample.wrongs) row.push_back(fmt::format("{:.4g}", wrong));
    table.add(row);
  }
  return table;
}

}  // namespace mirage
