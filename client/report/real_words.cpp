#include "client/report/real_words.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace mirage {
namespace {

// Limits beyond which a figure stands in red.
constexpr double kMostLate = 0.05;          // share of frames
constexpr double kLongest = 3;              // budgets
constexpr double kMostPlaceholders = 0.01;  // share of the objects in view

std::string where(const RealRun& run) {
  return fmt::format("{} within {:g} ms", run.scene, run.budget_ms);
}

double longest_budgets(const RealRun& run) { return run.settled_ms.longest / run.budget_ms; }

// Returns the run with the largest value; runs without one come last.
template <typename Value>
const RealRun& most(const std::vector<RealRun>& runs, const Value& value) {
  const auto rank = [&](const RealRun& run) {
    const double v = value(run);
    return std::isnan(v) ? -INFINITY : v;
  };
  return *std::max_element(runs.begin(), runs.end(),
                           [&](const RealRun& a, const RealRun& b) { return rank(a) < rank(b); });
}

std::vector<RealRun> within_largest(const std::vector<RealRun>& runs) {
  const double largest = most(runs, [](const RealRun& run) { return run.budget_ms; }).budget_ms;
  std::vector<RealRun> out;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(out),
               [&](const RealRun& run) { return run.budget_ms == largest; });
  return out;
}

// Returns the smallest budget from which on all budgets of a scene are held; 0: there is none.
double smallest_held(const std::vector<RealRun>& runs, const std::string& scene) {
  std::map<double, bool> held;
  for (const RealRun& run : runs) {
    if (run.scene == scene) held[run.budget_ms] = run.held();
  }
  double smallest = 0;
  for (auto at = held.rbegin(); at != held.rend() && at->second; ++at) smallest = at->first;
  return smallest;
}

Finding held_finding(const std::vector<RealRun>& runs, const std::string& scene) {
  const double ms = smallest_held(runs, scene);
  return {ms > 0 ? fmt::format("{:g} ms", ms) : "none",
          scene + ": smallest budget that 95 of 100 frames keep, from the fifth second on",
          ms == 0};
}

Finding late_finding(const std::vector<RealRun>& runs) {
  int frames = 0, late = 0;
  std::map<std::string, int> causes;
  for (const RealRun& run : runs) {
    frames += run.frames;
    late += run.late;
    for (const RealStage& stage : run.stages) causes[stage.name] += stage.late;
  }
  const auto worst =
      std::max_element(causes.begin(), causes.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  const double share = frames > 0 ? static_cast<double>(late) / frames : 0;
  const std::string cause =
      late == 0 ? "" : fmt::format(", {} of {} by {}", worst->second, late, worst->first);
  return {fmt::format("{:.1f} %", 100 * share),
          fmt::format("of all frames within {:g} ms are late{}", runs.front().budget_ms, cause),
          share > kMostLate};
}

Finding longest_finding(const std::vector<RealRun>& runs) {
  const RealRun& worst = most(runs, longest_budgets);
  return {fmt::format("{:.0f} ms", worst.settled_ms.longest),
          "longest frame from the fifth second on, " + where(worst),
          longest_budgets(worst) > kLongest};
}

Finding placeholder_finding(const std::vector<RealRun>& runs) {
  const RealRun& worst = most(runs, [](const RealRun& run) { return run.settled_placeholders; });
  return {fmt::format("{:.1f} %", 100 * worst.settled_placeholders),
          "of the objects in view have no image from the fifth second on, " + where(worst),
          worst.settled_placeholders > kMostPlaceholders};
}

}  // namespace

std::vector<Finding> real_findings(const std::vector<RealRun>& runs) {
  std::vector<Finding> out;
  std::vector<std::string> scenes;
  for (const RealRun& run : runs) {
    if (std::find(scenes.begin(), scenes.end(), run.scene) == scenes.end()) {
      scenes.push_back(run.scene);
    }
  }
  for (const std::string& scene : scenes) out.push_back(held_finding(runs, scene));
  const std::vector<RealRun> largest = within_largest(runs);
  out.push_back(late_finding(largest));
  out.push_back(longest_finding(largest));
  out.push_back(placeholder_finding(largest));
  return out;
}

std::string real_shortfall(const RealRun& run) {
  if (std::isnan(run.settled_ms.p95)) {
    return where(run) + ": no frame was drawn from the fifth second on.";
  }
  std::vector<std::string> parts;
  if (!run.held()) {
    parts.push_back(fmt::format("95 of 100 frames take up to {:.1f} ms from the fifth second on",
                                run.settled_ms.p95));
    parts.push_back(fmt::format("{} of {} frames are late, most by {}", run.late, run.frames,
                                run.worst_stage()));
  }
  if (run.very_late > 0) {
    parts.push_back(fmt::format("{} of {} frames take longer than 3 budgets, the first one apart",
                                run.very_late, run.frames));
  }
  if (run.settled_placeholders > kMostPlaceholders) {
    parts.push_back(
        fmt::format("{:.1f} % of the objects in view have no image from the fifth second on",
                    100 * run.settled_placeholders));
  }
  if (parts.empty()) return "";
  std::string line = where(run);
  for (std::size_t i = 0; i < parts.size(); ++i) line += (i == 0 ? ": " : "; ") + parts[i];
  return line + ".";
}

}  // namespace mirage
