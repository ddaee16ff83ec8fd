#include "client/report/work_precision_rows.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "client/report/pareto.h"
#include "protocol/base/quantile.h"

namespace mirage {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

std::vector<Setting> settings_of(const std::vector<std::string>& methods,
                                 const std::vector<double>& taus,
                                 const std::vector<double>& budgets, double pictured_budget) {
  std::vector<Setting> out;
  // Methods beside each other in time: the machine's load drifts.
  for (const double tau : taus) {
    for (const int samples : {1, 4}) {
      if (samples > 1 && tau != 1) continue;  // what samples are worth shows at one tau
      for (const std::string& method : methods) {
        if (method == "auto") continue;
        out.push_back({method, tau, samples, 0, tau == 1 && samples == 4});
      }
    }
    out.push_back({"auto", tau, -1, 0, tau == 1});
  }
  for (const double budget : budgets) {
    out.push_back({"auto", 1, -1, budget, budget == pictured_budget});
  }
  return out;
}

using Value = std::function<std::optional<double>(const Figures&)>;
struct CostAxis {
  const char* label;
  Value value;
  std::optional<Cost> fronted;  ///< has a front against FLIP
};

const std::vector<CostAxis>& costs() {
  static const std::vector<CostAxis> axes = {
      {"client, ms per frame", [](const Figures& f) { return f.client_ms; }, Cost::kClientMs},
      {"both ways, kB/s", [](const Figures& f) { return 1e-3 * f.bytes_per_s; }, Cost::kBytesPerS},
      {"server, ms per tile", [](const Figures& f) { return f.server_ms; }, {}},
      {"request to display, ms", [](const Figures& f) { return f.display_ms; }, {}}};
  return axes;
}

struct ErrorAxis {
  const char* id;
  const char* label;
  Value value;
  std::function<std::optional<double>(const Floor&)> floor;
};

const std::vector<ErrorAxis>& errors() {
  static const std::vector<ErrorAxis> axes = {
      {"e2", "E2 FLIP, mean", [](const Figures& f) { return f.flip; },
       [](const Floor& f) { return f.flip; }},
      {"e1", "E1 geometric error p99, px", [](const Figures& f) { return f.e1_p99; },
       [](const Floor&) { return std::optional<double>(); }},
      {"e4", "E4 coverage error 1-IoU",
       [](const Figures& f) { return f.iou ? std::optional<double>(1 - *f.iou) : std::nullopt; },
       [](const Floor& f) { return f.iou_error; }},
      {"e6", "E6 flicker, mean", [](const Figures& f) { return f.flicker; },
       [](const Floor& f) { return f.flicker; }}};
  return axes;
}

Panel panel_for(const std::vector<Figures>& all, const ErrorAxis& error, const CostAxis& cost,
                const Floor& floor) {
  Panel panel{"", cost.label, error.label, true, true, {}, error.floor(floor), {}};
  const std::string id = error.id;
  const std::vector<bool> front =
      cost.fronted && id == "e2" ? front_by(all, *cost.fronted) : std::vector<bool>(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Figures& f = all[i];
    const std::string name = f.setting.series();
    const std::pair<double, double> point = {cost.value(f).value_or(NAN),
                                             error.value(f).value_or(NAN)};
    auto series = std::find_if(panel.series.begin(), panel.series.end(),
                               [&](const Series& s) { return s.name == name; });
    if (series == panel.series.end()) series = panel.series.insert(series, Series{name, {}});
    series->points.push_back(point);
    if (front[i]) panel.front.push_back(point);
  }
  std::sort(panel.front.begin(), panel.front.end());
  return panel;
}

// Cheapest at which auto errs no more, anywhere on the lines between the settings of its front:
// a budget, or a tau, is a number.
double auto_cost_at(const std::vector<CostError>& auto_front, double error) {
  for (std::size_t i = 0; i < auto_front.size(); ++i) {
    const CostError& b = auto_front[i];
    if (b.error > error) continue;
    if (i == 0) return b.cost;
    const CostError& a = auto_front[i - 1];
    return a.cost + (b.cost - a.cost) * (a.error - error) / (a.error - b.error);
  }
  return kNever;
}

std::vector<CostError> points_of(const std::vector<Figures>& all, Cost cost) {
  std::vector<CostError> points;
  for (const Figures& f : all) points.push_back({cost_of(f, cost), f.flip.value_or(NAN)});
  return points;
}

std::string with_unit(double value, Cost cost) {
  if (std::isinf(value)) return "never";
  return cost == Cost::kBytesPerS ? fmt::format("{:.0f} kB/s", 1e-3 * value)
                                  : fmt::format("{:.1f} ms", value);
}

std::string words(Cost cost, double slack) {
  switch (cost) {
    case Cost::kClientMs:
      return fmt::format("client ms (within {:.0f} %)", 100 * slack);
    case Cost::kModelMs:
      return "the device model's ms (95th percentile)";
    case Cost::kBytesPerS:
      return "bytes";
  }
  return {};
}

}  // namespace

std::string Setting::name() const {
  if (budget_ms > 0) return fmt::format("{} within {:g} ms", method, budget_ms);
  if (samples < 0) return fmt::format("{} at tau {:g} px", method, tau_px);
  return fmt::format("{} at tau {:g} px, {} sample{}", method, tau_px, samples,
                     samples > 1 ? "s" : "");
}

std::string Setting::series() const {
  if (automatic()) return budget_ms > 0 ? "auto, by budget" : "auto";
  return samples == 1 ? method + ", 1 sample" : method;
}

Sweep work_sweep(bool quick, const std::vector<std::string>& methods) {
  if (quick) {
    return {{"builtin:forest?trees=60", "builtin:clutter?objects=150",
             "builtin:museum?objects=12&triangles=60000"},
            settings_of(methods, {4, 1}, {8, 16, 33}, 33),
            240,
            135,
            15,
            91,
            {30, 60, 89, 90}};
  }
  return {{"builtin:forest", "builtin:clutter", "builtin:city", "builtin:museum?objects=60"},
          settings_of(methods, {4, 1}, {16, 33, 50, 100, 200}, 50),
          640,
          360,
          15,
          91,
          {30, 60, 89, 90}};
}

double cost_of(const Figures& figures, Cost cost) {
  switch (cost) {
    case Cost::kClientMs:
      return figures.client_ms;
    case Cost::kModelMs:
      return figures.client_ms_p95.value_or(NAN);
    case Cost::kBytesPerS:
      return figures.bytes_per_s;
  }
  return NAN;
}

std::vector<bool> front_by(const std::vector<Figures>& all, Cost cost) {
  return pareto_front(points_of(all, cost));
}

double spread_of(const std::vector<Figures>& all) {
  std::vector<double> spreads;
  for (const Figures& f : all) spreads.insert(spreads.end(), f.spreads.begin(), f.spreads.end());
  return spreads.empty() ? 0 : quantile(spreads, 0.5) - 1;
}

std::vector<LeftOfAuto> left_of_auto(const std::vector<Figures>& all, Cost cost, double slack) {
  std::vector<CostError> automatic, front;
  for (const Figures& f : all) {
    if (f.setting.automatic()) automatic.push_back({cost_of(f, cost), f.flip.value_or(NAN)});
  }
  const std::vector<bool> on = pareto_front(automatic);
  for (std::size_t i = 0; i < automatic.size(); ++i) {
    if (on[i]) front.push_back(automatic[i]);
  }
  std::sort(front.begin(), front.end(),
            [](const CostError& a, const CostError& b) { return a.cost < b.cost; });
  std::vector<LeftOfAuto> out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].setting.automatic() || !all[i].flip) continue;
    const double auto_cost = auto_cost_at(front, *all[i].flip);
    if (cost_of(all[i], cost) * (1 + slack) < auto_cost) out.push_back({i, auto_cost});
  }
  return out;
}

std::string say_of_auto(const std::vector<Figures>& all, Cost cost, double slack) {
  const auto fixed = std::count_if(all.begin(), all.end(),
                                   [](const Figures& f) { return !f.setting.automatic(); });
  const std::string by = words(cost, slack);
  const std::vector<LeftOfAuto> left = left_of_auto(all, cost, slack);
  if (left.empty()) return fmt::format("By {} auto is on or left of every fixed method.", by);
  std::string out = fmt::format("By {} {} of {} settings of fixed methods stand left of auto: ", by,
                                left.size(), fixed);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const Figures& f = all[left[i].index];
    out +=
        fmt::format("{}{}, {}, FLIP {:.4f} (auto: {})", i > 0 ? "; " : "", f.setting.name(),
                    with_unit(cost_of(f, cost), cost), *f.flip, with_unit(left[i].auto_cost, cost));
  }
  return out + ".";
}

std::vector<ErrorPlot> error_plots(const std::vector<Figures>& all, const Floor& floor) {
  std::vector<ErrorPlot> out;
  for (const ErrorAxis& error : errors()) {
    ErrorPlot plot{error.id, error.label, {}};
    for (const CostAxis& cost : costs()) plot.panels.push_back(panel_for(all, error, cost, floor));
    out.push_back(std::move(plot));
  }
  return out;
}

Table work_precision_table() {
  return Table({"scene",
                "method",
                "tau_px",
                "client_ms",
                "server_ms_per_tile",
                "bytes_per_s",
                "request_to_display_ms",
                "e1_px_p99",
                "e1_px_max",
                "flip_mean",
                "psnr_db",
                "ssim",
                "iou",
                "flicker",
                "pareto",
                "commit",
                "renderer",
                "revision",
                "budget_ms",
                "client_ms_p95",
                "scale",
                "samples"});
}

void add_rows(Table& table, const std::vector<Figures>& all, const RowOrigin& origin) {
  const std::vector<bool> front = front_by(all, Cost::kClientMs);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Figures& f = all[i];
    std::optional<double> scale, samples;
    if (f.frame_setting) scale = f.frame_setting->scale;
    if (f.frame_setting) samples = f.frame_setting->samples;
    table.add({origin.scene,
               f.setting.method,
               figure(f.setting.tau_px),
               figure(f.client_ms),
               figure(f.server_ms),
               figure(f.bytes_per_s),
               figure(f.display_ms),
               figure(f.e1_p99),
               figure(f.e1_max),
               figure(f.flip),
               figure(f.psnr),
               figure(f.ssim),
               figure(f.iou),
               figure(f.flicker),
               front[i] ? "1" : "0",
               origin.commit,
               origin.renderer,
               origin.revision,
               figure(f.setting.budget_ms),
               figure(f.client_ms_p95),
               figure(scale),
               figure(samples)});
  }
}

Table dominated_settings(const std::vector<Figures>& all) {
  const std::vector<bool> front = front_by(all, Cost::kClientMs);
  Table table({"dominated setting"});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Figures& f = all[i];
    const double flip = f.flip.value_or(INFINITY);
    for (std::size_t k = 0; k < all.size() && !front[i]; ++k) {
      const Figures& by = all[k];
      if (!front[k] || by.client_ms > f.client_ms || *by.flip > flip) continue;
      table.add({fmt::format("{}: {:.1f} ms, FLIP {:.4f}; {} takes {:.1f} ms for {:.4f}",
                             f.setting.name(), f.client_ms, flip, by.setting.name(), by.client_ms,
                             *by.flip)});
      break;
    }
  }
  return table;
}

}  // namespace mirage
