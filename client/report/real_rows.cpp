#include "client/report/real_rows.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace mirage {
namespace {

using json = nlohmann::ordered_json;  // stages stay in the order of the flow

constexpr double kLate = 1.1;  // budgets; as the viewer counts

double number_at(const json& j, const std::string& pointer) {
  const json::json_pointer at(pointer);
  return j.contains(at) && j[at].is_number() ? j[at].get<double>() : NAN;
}

int count_at(const json& j, const std::string& pointer) {
  const double n = number_at(j, pointer);
  return std::isnan(n) ? 0 : static_cast<int>(n);
}

FrameTimes times_at(const json& j, const std::string& pointer) {
  return {number_at(j, pointer + "/p50"), number_at(j, pointer + "/p95"),
          number_at(j, pointer + "/max")};
}

double percent(int part, int whole) { return whole > 0 ? 100.0 * part / whole : NAN; }

// Returns the panel with this title; adds it first if it is new.
Panel& panel_of(std::vector<Panel>& panels, const std::string& title, const std::string& label) {
  const auto at = std::find_if(panels.begin(), panels.end(),
                               [&](const Panel& panel) { return panel.title == title; });
  if (at != panels.end()) return *at;
  return panels.emplace_back(Panel{title, "budget, ms", label, true, false, {}, {}, {}});
}

void add_point(Panel& panel, const std::string& name, double budget_ms, double value) {
  const auto at = std::find_if(panel.series.begin(), panel.series.end(),
                               [&](const Series& series) { return series.name == name; });
  Series& series = at != panel.series.end() ? *at : panel.series.emplace_back(Series{name, {}});
  series.points.emplace_back(budget_ms, value);
}

void add_times(Panel& panel, double budget_ms, const FrameTimes& ms) {
  panel.log_y = true;
  add_point(panel, "budget", budget_ms, budget_ms);
  add_point(panel, "p50", budget_ms, ms.p50);
  add_point(panel, "p95", budget_ms, ms.p95);
  add_point(panel, "longest", budget_ms, ms.longest);
}

}  // namespace

RealPlan real_plan(bool quick) {
  if (quick) return {{"builtin:forest"}, {16, 50}, 640, 360, 6};
  return {{"builtin:forest", "builtin:clutter"}, {4, 8, 16, 33, 50}, 1280, 720, 20};
}

bool RealRun::held() const { return settled_ms.p95 <= kLate * budget_ms; }

std::string RealRun::worst_stage() const {
  const auto worst =
      std::max_element(stages.begin(), stages.end(),
                       [](const RealStage& a, const RealStage& b) { return a.late < b.late; });
  return worst == stages.end() || worst->late == 0 ? "none" : worst->name;
}

std::optional<RealRun> read_real_run(const std::string& statistics, const std::string& real_time) {
  const json stats = json::parse(statistics, nullptr, false);
  const json clock = json::parse(real_time, nullptr, false);
  const json::json_pointer causes("/drawn/late_causes");
  if (!stats.is_object() || !clock.is_object() || !clock.contains(causes)) return std::nullopt;
  RealRun run;
  run.scene = stats.value("scene", "");
  run.budget_ms = number_at(stats, "/budget_ms");
  run.scale = number_at(stats, "/scale");
  run.samples = number_at(stats, "/samples");
  run.first_picture_ms = number_at(stats, "/first_picture_ms");
  run.frames = count_at(clock, "/drawn/frames");
  run.ms = times_at(clock, "/drawn/ms");
  run.settled_ms = times_at(clock, "/drawn/ms_after_5s");
  run.late = count_at(clock, "/drawn/late");
  run.very_late = count_at(clock, "/drawn/over_3_budgets");
  for (const auto& cause : clock[causes].items()) {
    run.stages.push_back({cause.key(), times_at(clock, "/drawn/stage_ms/" + cause.key()),
                          count_at(clock, "/drawn/late_causes/" + cause.key())});
  }
  run.placeholders = number_at(clock, "/drawn/placeholder_fraction");
  run.settled_placeholders = number_at(clock, "/drawn/placeholder_fraction_after_5s");
  run.renderer = clock.value("client_renderer", "");
  return run;
}

Table real_table(const std::vector<RealRun>& runs) {
  Table table({"scene", "budget_ms", "frames", "frame_ms_p50", "frame_ms_p95", "frame_ms_max",
               "settled_ms_p50", "settled_ms_p95", "settled_ms_max", "late", "over_3_budgets",
               "late_by", "placeholders", "settled_placeholders", "scale_mean", "samples_mean",
               "first_picture_ms"});
  for (const RealRun& run : runs) {
    table.add({run.scene, figure(run.budget_ms), std::to_string(run.frames), figure(run.ms.p50),
               figure(run.ms.p95), figure(run.ms.longest), figure(run.settled_ms.p50),
               figure(run.settled_ms.p95), figure(run.settled_ms.longest), std::to_string(run.late),
               std::to_string(run.very_late), run.worst_stage(), figure(run.placeholders),
               figure(run.settled_placeholders), figure(run.scale), figure(run.samples),
               figure(run.first_picture_ms)});
  }
  return table;
}

Table real_stages(const std::vector<RealRun>& runs) {
  Table table({"scene", "budget_ms", "stage", "stage_ms_p50", "stage_ms_p95", "stage_ms_max",
               "caused_late"});
  for (const RealRun& run : runs) {
    for (const RealStage& stage : run.stages) {
      table.add({run.scene, figure(run.budget_ms), stage.name, figure(stage.ms.p50),
                 figure(stage.ms.p95), figure(stage.ms.longest), std::to_string(stage.late)});
    }
  }
  return table;
}

std::vector<Panel> frame_panels(const std::vector<RealRun>& runs) {
  std::vector<Panel> panels;
  for (const RealRun& run : runs) {
    add_times(panel_of(panels, run.scene + ", whole walk", "frame, ms"), run.budget_ms, run.ms);
    add_times(panel_of(panels, run.scene + ", from the fifth second on", "frame, ms"),
              run.budget_ms, run.settled_ms);
  }
  return panels;
}

std::vector<Panel> late_panels(const std::vector<RealRun>& runs) {
  std::vector<Panel> panels;
  for (const RealRun& run : runs) {
    Panel& panel = panel_of(panels, run.scene, "late frames, % of all");
    add_point(panel, "all causes", run.budget_ms, percent(run.late, run.frames));
    for (const RealStage& stage : run.stages) {
      const bool ever = std::any_of(runs.begin(), runs.end(), [&](const RealRun& other) {
        return std::any_of(other.stages.begin(), other.stages.end(),
                           [&](const RealStage& s) { return s.name == stage.name && s.late > 0; });
      });
      if (ever) add_point(panel, stage.name, run.budget_ms, percent(stage.late, run.frames));
    }
  }
  return panels;
}

std::vector<Panel> picture_panels(const std::vector<RealRun>& runs) {
  std::vector<Panel> panels;
  for (const RealRun& run : runs) {
    Panel& panel = panel_of(panels, run.scene, "share, and scale");
    add_point(panel, "scale", run.budget_ms, run.scale);
    add_point(panel, "placeholders", run.budget_ms, run.placeholders);
    add_point(panel, "placeholders from the fifth second on", run.budget_ms,
              run.settled_placeholders);
  }
  return panels;
}

}  // namespace mirage
