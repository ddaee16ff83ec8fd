#include "client/report/real.h"

#include <spdlog/fmt/fmt.h>

#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "client/host/server_process.h"
#include "client/report/real_words.h"
#include "protocol/process/child.h"

namespace mirage {
namespace {

using nlohmann::ordered_json;

constexpr double kBusy = 0.5;  // load average of a core; above it the page says so
constexpr const char *kRealPart = "real", *kFolder = "real";

/// A run with what the viewer wrote about it.
struct Walk {
  RealRun run;
  ordered_json json;
};

std::string read_real_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The machine, before the first walk.
struct Machine {
  std::string processor = "of unknown kind";
  unsigned cores = std::thread::hardware_concurrency();
  double load = NAN;  ///< processes that ran or waited for a core, mean of the last minute

  static Machine now();
};

Machine Machine::now() {
  Machine machine;
  if (getloadavg(&machine.load, 1) != 1) machine.load = NAN;
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line)) {
    if (line.rfind("model name", 0) != 0) continue;
    machine.processor = line.substr(line.find(": ") + 2);
    break;
  }
  return machine;
}

std::string file_name(const std::string& scene, double budget_ms) {
  std::string name = scene;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return fmt::format("{}_{:g}ms", name, budget_ms);
}

std::vector<std::string> view_arguments(const RealPlan& plan, const std::string& url,
                                        double budget_ms, const std::string& file) {
  return {url,
          "--offscreen",
          fmt::format("{}x{}", plan.width, plan.height),
          "--frame-ms",
          fmt::format("{:g}", budget_ms),
          "--path",
          "builtin:walk",
          "--seconds",
          fmt::format("{:g}", plan.seconds),
          "--stats",
          file + ".json",
          "--trace",
          file + ".trace.json"};
}

// Returns the commands that repeat a walk by hand; the first one only without --url.
std::vector<std::string> by_hand(const Context& context, const RealPlan& plan,
                                 const std::string& scene, double budget_ms) {
  std::vector<std::string> commands;
  std::string url = context.options.url;
  if (url.empty()) {
    url = "ws://127.0.0.1:9870";
    commands.push_back("mirage-server '" + scene + "' --listen 127.0.0.1:9870");
  }
  std::string view = "mirage-view";
  for (const std::string& word : view_arguments(plan, url, budget_ms, "walk")) view += " " + word;
  commands.push_back(view);
  return commands;
}

// Walks through a scene within a budget, from a server that has just started.
Result<Walk> walk(const Context& context, const RealPlan& plan, const std::string& scene,
                  double budget_ms) {
  const std::optional<std::string> viewer = sibling_program("mirage-view");
  if (!viewer) return make_error(ErrorId::kIo, "there is no mirage-view beside mirage-report");
  std::unique_ptr<ServerProcess> server;
  std::string url = context.options.url;
  if (url.empty()) {
    auto started = ServerProcess::start(scene, context.options.device);
    if (!started) return started.error();
    server = started.take();
    url = server->url();
  }
  const std::string file = context.path(std::string(kFolder) + "/" + file_name(scene, budget_ms));
  std::vector<std::string> command = view_arguments(plan, url, budget_ms, file);
  command.insert(command.begin(), *viewer);
  command.insert(command.end(), {"--device", context.options.device});
  const Result<ChildResult> ran = run_child(command);
  if (!ran) return ran.error();
  if (ran->exit_code != 0) {
    return error_said(ran->err).value_or(make_error(
        ErrorId::kInternal, fmt::format("mirage-view ended with exit code {}", ran->exit_code)));
  }
  const std::string statistics = read_real_file(file + ".json");
  const std::string real_time = read_real_file(file + ".real_time.json");
  const std::optional<RealRun> run = read_real_run(statistics, real_time);
  if (!run) return make_error(ErrorId::kInternal, "mirage-view wrote no figures to " + file);
  return Walk{*run,
              {{"scene", run->scene},
               {"commands", by_hand(context, plan, scene, budget_ms)},
               {"statistics", ordered_json::parse(statistics)},
               {"real_time", ordered_json::parse(real_time)}}};
}

// Walks within each budget. A scene of the command line that cannot be walked through is an error,
// one of the part's own is an omission.
Result<std::vector<Walk>> walk_all(Context& context, const RealPlan& plan) {
  const std::vector<std::string> scenes = context.scenes_or(plan.scenes);
  context.progress.begin(kRealPart, scenes.size() * plan.budgets_ms.size());
  std::vector<Walk> out;
  for (const std::string& scene : scenes) {
    for (const double budget_ms : plan.budgets_ms) {
      const std::string what = fmt::format("{} within {:g} ms", scene, budget_ms);
      context.progress.step(what);
      Result<Walk> done = walk(context, plan, scene, budget_ms);
      const bool own = context.options.scene.empty() && context.options.url.empty();
      if (!done && !own) return done.error();
      if (!done) {
        context.omit(kRealPart, what, done.error().line());
        continue;
      }
      const FrameTimes &ms = done->run.ms, &settled = done->run.settled_ms;
      std::printf("%s: %.1f ms median, %.1f p95, %.1f longest; after 5 s %.1f, %.1f, %.1f\n",
                  what.c_str(), ms.p50, ms.p95, ms.longest, settled.p50, settled.p95,
                  settled.longest);
      std::fflush(stdout);
      out.push_back(done.take());
    }
  }
  return out;
}

void explain(Context& context, const RealPlan& plan, const Machine& machine,
             const std::string& renderer) {
  Page& page = context.page;
  page.command(context.options.command_line);
  page.method(fmt::format(
      "mirage-view walks {:g} s through each scene within each budget, in real time, at {}x{} "
      "pixels without a display. {} The renderer of the viewer is {}. The machine has {} cores "
      "({}); its load average before the first walk was {:.1f}.",
      plan.seconds, plan.width, plan.height,
      context.options.url.empty()
          ? "Each walk has a mirage-server of its own on the same machine, started for it."
          : "The server was running before, so later walks meet tiles that it holds.",
      renderer, machine.cores, machine.processor, machine.load));
  page.method(
      "A frame's time is what the viewer works on it: receiving, uploads, planning, drawing until "
      "the renderer has finished. Waiting for the next frame is not part of it. A late frame takes "
      "longer than 1.1 budgets; its cause is the stage that took the most time beyond its median. "
      "The first 5 s load the scene, so figures from the fifth second on stand beside those of "
      "the whole walk. Placeholders are objects in view that are drawn without an image of their "
      "own. Anything else that this machine does changes the figures.");
  page.method(
      "One row by hand: walk.real_time.json then has its times, walk.json its scale, and "
      "walk.trace.json each frame. The folder real has these files of all rows.");
  const std::string scene = context.scenes_or(plan.scenes).front();
  for (const std::string& line : by_hand(context, plan, scene, plan.budgets_ms.back())) {
    page.command(line);
  }
}

void show(Context& context, const Machine& machine, const std::vector<RealRun>& runs) {
  Page& page = context.page;
  if (machine.load > kBusy * machine.cores) {
    page.paragraph(fmt::format(
        "The machine was busy before the first walk: load average {:.1f} on {} cores. On an idle "
        "one frames are shorter.",
        machine.load, machine.cores));
  }
  std::vector<bool> marked;
  for (const Finding& finding : real_findings(runs)) page.finding(finding);
  for (const RealRun& run : runs) {
    const std::string shortfall = real_shortfall(run);
    if (!shortfall.empty()) page.falls_short(shortfall);
    marked.push_back(!run.held());
  }
  const auto plot = [&](const char* name, const std::vector<Panel>& panels, const char* caption) {
    context.plot(name, panels, panels.size() > 1 ? 2 : 1, caption);
  };
  plot("real_frames", frame_panels(runs),
       "Time of a frame against its budget. On the line a frame takes its budget.");
  plot("real_late", late_panels(runs),
       "Share of late frames, and of those that each stage made late.");
  plot("real_picture", picture_panels(runs),
       "What the budget costs: scale of the picture, and share of the objects in view without an "
       "image.");
  page.table(real_table(runs), marked);
  page.folded("Stages of these frames", real_stages(runs));
}

}  // namespace

Result<void> report_real(Context& context) {
  const RealPlan plan = real_plan(context.options.quick);
  std::error_code failed;
  std::filesystem::create_directories(context.path(kFolder), failed);
  if (failed)
    return make_error(ErrorId::kIo, "cannot make directory '" + context.path(kFolder) + "'");
  context.page.section(kRealPart, "Frames by the clock");
  const Machine machine = Machine::now();
  Result<std::vector<Walk>> walks = walk_all(context, plan);
  if (!walks) return walks.error();
  std::vector<RealRun> runs;
  ordered_json rows = ordered_json::array();
  for (const Walk& walk : *walks) {
    runs.push_back(walk.run);
    rows.push_back(walk.json);
  }
  if (!runs.empty()) {
    show(context, machine, runs);
    explain(context, plan, machine, runs.front().renderer);
  }
  const std::pair<const char*, std::string> files[] = {
      {"real.csv", real_table(runs).csv()},
      {"real_stages.csv", real_stages(runs).csv()},
      {"real.json", ordered_json{{"machine",
                                  {{"processor", machine.processor},
                                   {"cores", machine.cores},
                                   {"load_average", machine.load}}},
                                 {"rows", rows}}
                            .dump(1) +
                        "\n"}};
  for (const auto& [name, text] : files) {
    if (Result<void> written = write_file(context.path(name), text); !written) return written;
  }
  return {};
}

}  // namespace mirage
